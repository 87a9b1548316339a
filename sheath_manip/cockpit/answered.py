"""A simulated person at the cockpit: the gate of `--expert person`, answered by nobody's hand.

He does what a person can do at the page and nothing else: he sees that the robot asks, takes over,
drives, sees that the gate would let the policy go on, and hands back. Time is the robot's own, and
goes on as well while the robot stands still and waits for him.
"""

from dataclasses import dataclass, field, replace

import numpy as np

from sheath_manip.cockpit.cockpit import Cockpit
from sheath_manip.cockpit.driver import OperatedDriver
from sheath_manip.cockpit.gate import WAIT_S
from sheath_manip.cockpit.orders import Order
from sheath_manip.gates.patient import FOR_PEOPLE, RequestConfig
from sheath_manip.protocols import Environment, Gate
from sheath_manip.rollout.request import Crew, Driver
from sheath_manip.rollout.simulated_operator import (
    OperatorConfig,
    OperatorHand,
    SimulatedOperator,
)
from sheath_manip.task import HOLD, SCRIPTED, Task
from sheath_manip.types import Actor, GateDecision, Observation, Proposal
from sheath_manip.types.operator_input import Binding, OperatorInput

STATION = "simulated"
GLANCE_S = 0.02
"""between two looks while the robot stands still"""
_KEY = "held"
_HOLDS = OperatorInput(keys=frozenset({_KEY}))


class AnsweredCockpit(Cockpit):
    """A cockpit with somebody in it, and a clock of its own."""

    def __init__(self, operator: SimulatedOperator) -> None:
        self.operator = operator
        self._clock_s = 0.0
        super().__init__((Binding((_KEY,), "drive"),), lambda: self._clock_s)

    def rest(self) -> float:
        """Let a moment pass, in which nothing moves but he."""
        self.let_pass(GLANCE_S)
        return GLANCE_S

    def let_pass(self, seconds: float) -> None:
        """Let time pass, and him look."""
        self._clock_s += seconds
        state = self.state
        trouble = not state.may_go_on if state.taken else state.asking
        drives = self.operator.drives(trouble, self._clock_s)
        if drives is not state.taken:
            self.order(Order.TAKE_OVER if drives else Order.HAND_BACK, STATION)
        if drives:
            self.submit_input(STATION, _HOLDS)


class AnsweredGate:
    """A person's gate, and the time in which the person looks."""

    def __init__(self, gate: Gate, cockpit: AnsweredCockpit) -> None:
        self.gate = gate
        self.cockpit = cockpit
        self._seen_s = 0.0

    def reset(self, rng: np.random.Generator) -> None:
        """Begin an episode; his draws are of `rng`."""
        self.cockpit.operator.begin(rng.spawn(1)[0])
        self.cockpit.begin_episode()
        self.gate.reset(rng)
        self._seen_s = 0.0

    def decide(self, observation: Observation, proposal: Proposal | None) -> GateDecision:
        """Let him look, then decide."""
        passed_s, self._seen_s = observation.time_s - self._seen_s, observation.time_s
        self.cockpit.let_pass(max(0.0, passed_s))
        return self.gate.decide(observation, proposal)


@dataclass(frozen=True)
class AnsweredDriver:
    """Another driver, whose expert is a simulated person; episodes follow each other before him."""

    driver: Driver
    operator: OperatorConfig = field(default_factory=OperatorConfig)
    fallback: str = SCRIPTED
    """the expert, or a fallback controller by its name, that acts where he does not come"""
    wait_s: float = WAIT_S
    """for him, before the fallback acts"""
    requests: RequestConfig = FOR_PEOPLE
    """how seldom he is asked, where the other driver's gate does not say"""

    def crew(self, task: Task, environment: Environment) -> Crew:
        """Put his gate around the other driver's, and him beside its crew."""
        operator, spec = SimulatedOperator(self.operator), environment.spec
        cockpit = AnsweredCockpit(operator)
        operated = OperatedDriver(
            self.driver,
            cockpit,
            fallback=self.fallback,
            hold=HOLD if HOLD in task.fallbacks else None,
            wait_s=self.wait_s,
            requests=self.requests,
        )
        crew = operated.crew(task, environment)
        expert = task.make_expert(environment)
        hand = OperatorHand(expert, operator, spec.action, spec.control_rate_hz)
        gate = AnsweredGate(crew.gate, cockpit)
        return replace(crew, gate=gate, others={**crew.others, Actor.OPERATOR: hand})
