"""A simulated operator: he notices late, stays a while, and errs; what he knows is the script's.

So what a person's turns come to has numbers that can be had again. What he is to see, and what he
does with the wheel, is said where he sits: at the cockpit, or beside a policy that nothing watches.
"""

from dataclasses import dataclass

import numpy as np

from sheath_manip.exceptions import ParameterError
from sheath_manip.protocols import Expert, Follows, TakesOver
from sheath_manip.types import Action, ActionSpec, Observation

MINUTE_S = 60.0


@dataclass(frozen=True)
class OperatorConfig:
    """What is simulated of a person."""

    # A choice, for one who watches. What it hangs on, and that its spread grows with it: Zhang et
    # al. 2019, 'Determinants of take-over time from automated driving: a meta-analysis of 129
    # studies' (Transportation Research Part F).
    reaction_s: float = 1.2
    """mean time from what he could see to what he does about it: to take over, and to hand back"""
    reaction_spread_s: float = 0.3
    """standard deviation of it (gamma distribution)"""
    attention_s: float = 1.0
    """least time for which he drives once he has taken over, before he thinks of handing back"""
    overlooked: float = 0.0
    """share of what he should take over for that he never notices, 0 .. 1"""
    slips_a_minute: float = 0.0
    """wrong actions in a minute of driving: any that the task admits"""
    slip_s: float = 0.3
    """for how long he does the wrong thing"""

    def __post_init__(self) -> None:
        for name in ("reaction_spread_s", "attention_s", "slips_a_minute", "slip_s"):
            if not 0 <= getattr(self, name) < np.inf:
                raise ParameterError(f"{name} is {getattr(self, name)}; wanted at least 0")
        if not 0 < self.reaction_s < np.inf:
            raise ParameterError(f"reaction_s is {self.reaction_s}; wanted more than 0, like 1.2")
        if not 0 <= self.overlooked <= 1:
            raise ParameterError(f"overlooked is {self.overlooked}; wanted a share, 0 .. 1")


class SimulatedOperator:
    """Says from moment to moment whether he drives; times are seconds of one clock."""

    def __init__(self, config: OperatorConfig) -> None:
        self.config = config
        self._rng = np.random.default_rng(0)
        self._since_s: float | None = None
        """when he took over; None while he does not drive"""
        self._due_s: float | None = None
        """when he acts upon what he sees; None where he sees nothing to act upon"""
        self._slips_until_s = -np.inf
        self._slip: Action | None = None

    def begin(self, rng: np.random.Generator) -> None:
        """Draw from `rng` from now on; who drives drives on."""
        self._rng = rng
        self._slips_until_s = -np.inf

    def leave(self) -> None:
        """Let go of the wheel, and forget what was seen."""
        self._since_s = self._due_s = None

    def drives(self, trouble: bool, now_s: float) -> bool:
        """Return whether he drives at `now_s`, when there is `trouble` to be seen or none."""
        if self._since_s is None:
            if self._acts_upon(trouble, now_s, self.config.overlooked):
                self._since_s, self._due_s = now_s, None
        elif now_s - self._since_s >= self.config.attention_s and self._acts_upon(
            not trouble, now_s
        ):
            self._since_s = self._due_s = None
        return self._since_s is not None

    def slipped(self, meant: Action, spec: ActionSpec, now_s: float, period_s: float) -> Action:
        """(a,) what his hand does where he means `meant`, in a step of `period_s`."""
        if now_s >= self._slips_until_s:
            self._slip = None
            # One draw a step, so that how often he slips moves no other draw.
            if self._rng.random() < self.config.slips_a_minute * period_s / MINUTE_S:
                self._slips_until_s = now_s + self.config.slip_s
                self._slip = _any_action(spec, self._rng)
        return meant if self._slip is None else self._slip

    def _acts_upon(self, seen: bool, now_s: float, overlooked: float = 0.0) -> bool:
        """Whether what is `seen` has been for as long as it takes him."""
        if not seen:
            self._due_s = None
            return False
        if self._due_s is None:
            missed = self._rng.random() < overlooked
            self._due_s = np.inf if missed else now_s + self._reaction_s()
        return now_s >= self._due_s

    def _reaction_s(self) -> float:
        mean, spread = self.config.reaction_s, self.config.reaction_spread_s
        if spread == 0:
            return mean
        return float(self._rng.gamma((mean / spread) ** 2, spread**2 / mean))


class OperatorHand:
    """The task's scripted expert in his hand, which slips."""

    def __init__(
        self,
        expert: Expert,
        operator: SimulatedOperator,
        spec: ActionSpec,
        control_rate_hz: float,
    ) -> None:
        """Store who knows what to do, and who does it."""
        self.expert = expert
        self.operator = operator
        self.spec = spec
        self._period_s = 1 / control_rate_hz

    def reset(self) -> None:
        """A new episode."""
        self.expert.reset()

    def follow(self, observation: Observation) -> None:
        """Pass on, where the expert wants to know."""
        if isinstance(self.expert, Follows):
            self.expert.follow(observation)

    def take_over(self, observation: Observation) -> None:
        """Pass on, where the expert wants to know."""
        if isinstance(self.expert, TakesOver):
            self.expert.take_over(observation)

    def act(self, observation: Observation) -> Action:
        """(a,) what he does."""
        meant = self.expert.act(observation)
        return self.operator.slipped(meant, self.spec, observation.time_s, self._period_s)


def _any_action(spec: ActionSpec, rng: np.random.Generator) -> Action:
    if spec.choices is not None:
        return np.asarray(spec.choices[rng.integers(len(spec.choices))], np.float32)
    return rng.uniform(spec.minimum, spec.maximum).astype(np.float32)
