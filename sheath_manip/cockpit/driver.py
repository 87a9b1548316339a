"""What drives an episode with a person beside it."""

from dataclasses import dataclass

from sheath_manip.cockpit.cockpit import Cockpit
from sheath_manip.cockpit.environment import OperatedEnvironment
from sheath_manip.cockpit.gate import WAIT_S, PersonGate
from sheath_manip.cockpit.operator import beside_the_policy
from sheath_manip.exceptions import ParameterError
from sheath_manip.gates.human import HumanGate, Nobody
from sheath_manip.gates.labels.gate import LabellingGate
from sheath_manip.gates.patient import FOR_PEOPLE, PatientGate, RequestConfig
from sheath_manip.protocols import Environment, Holds
from sheath_manip.rollout.request import Crew, Driver
from sheath_manip.task import SCRIPTED, Task


@dataclass(frozen=True, eq=False)
class OperatedDriver:
    """Another driver, whose expert is the person at the cockpit; it lives in this process alone."""

    driver: Driver
    cockpit: Cockpit
    fallback: str = SCRIPTED
    """the expert, or a fallback controller by its name, that acts where nobody comes"""
    hold: str | None = None
    """the controller that keeps the robot where it is; None: the simulation stands still"""
    wait_s: float = WAIT_S
    """for the person, before the fallback acts"""
    dead_man: bool = True
    """whether the robot holds while no device is held"""
    requests: RequestConfig = FOR_PEOPLE
    """how seldom the person is asked, where the other driver's gate does not say"""

    def crew(self, task: Task, environment: Environment) -> Crew:
        """Put the person's gate around the other driver's, and the person beside its crew.

        ParameterError for a task that nobody can drive by hand.
        """
        if task.teleop is None:
            raise ParameterError(f"nobody can drive {task.name} by hand; wanted a task with teleop")
        inner = environment
        if isinstance(environment, OperatedEnvironment):
            inner = environment.environment
        crew = self.driver.crew(task, inner)
        fallback = task.make_expert(inner, self.fallback)
        hold = fallback if self.hold is None else task.make_expert(inner, self.hold)
        gate, requests = crew.gate, self.requests
        if isinstance(gate, LabellingGate):
            # Nobody is asked for a label without driving.
            gate = gate.gate
        if isinstance(gate, PatientGate):
            gate, requests = gate.gate, gate.config
        if isinstance(gate, HumanGate):
            # Who is at the cockpit says when, and nobody is simulated beside.
            gate = HumanGate(Nobody())
        gate = PersonGate(
            gate,
            self.cockpit,
            environment.spec.control_rate_hz,
            wait_s=self.wait_s,
            can_hold=self.hold is not None,
            dead_man=self.dead_man,
            fallback_teaches=self.fallback == SCRIPTED,
            stands_still=not isinstance(inner, Holds),
            hold=inner.hold if isinstance(inner, Holds) else None,
            requests=requests,
        )
        others = beside_the_policy(self.cockpit, task.teleop(inner), hold=hold, fallback=fallback)
        return Crew(gate, crew.policy, crew.expert, others)
