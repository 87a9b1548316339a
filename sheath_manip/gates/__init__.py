"""Gates: who acts at each step, and which states get the expert's label."""

from sheath_manip.gates.attentive import AttentivePerson
from sheath_manip.gates.blocks import RandomBlocks
from sheath_manip.gates.constant import AlwaysExpert, AlwaysPolicy
from sheath_manip.gates.human import HumanGate
from sheath_manip.gates.mixture import Mixture
from sheath_manip.gates.query import QueryFilter
from sheath_manip.gates.support import SupportGate
from sheath_manip.gates.takeover import RandomTakeover

__all__ = [
    "AlwaysExpert",
    "AlwaysPolicy",
    "AttentivePerson",
    "HumanGate",
    "Mixture",
    "QueryFilter",
    "RandomBlocks",
    "RandomTakeover",
    "SupportGate",
]
