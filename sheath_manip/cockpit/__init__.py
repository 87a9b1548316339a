"""The person at the controls, as the control loop sees it: orders, input, lease, gate and expert.

Nothing here knows the page: what brings a person's orders and input (a websocket, a button, a test)
hands them to the `Cockpit`, which follows them at once; the control loop looks there at each step.
"""

from sheath_manip.cockpit.cockpit import Cockpit
from sheath_manip.cockpit.environment import OperatedEnvironment
from sheath_manip.cockpit.gate import PersonGate
from sheath_manip.cockpit.operator import Operator, beside_the_policy
from sheath_manip.cockpit.orders import Order
from sheath_manip.types.operator_input import Gamepad, OperatorInput, SixAxes

__all__ = [
    "Cockpit",
    "Gamepad",
    "OperatedEnvironment",
    "Operator",
    "OperatorInput",
    "Order",
    "PersonGate",
    "SixAxes",
    "beside_the_policy",
]
