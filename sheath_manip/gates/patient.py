"""A gate that asks seldom and long enough: what it spares is requests, never an alarm."""

from dataclasses import dataclass, replace

import numpy as np

from sheath_manip.exceptions import ParameterError
from sheath_manip.protocols import Gate
from sheath_manip.types import Actor, GateDecision, Observation, Proposal, Reason

MINUTE_S = 60.0
ROUNDING_S = 1e-6


@dataclass(frozen=True)
class RequestConfig:
    """Limits on requests: how long a turn of the expert lasts, and how many there may be.

    They delay the hand-back. An alarm always gives the wheel to the expert, and who is asked too
    often keeps it.
    """

    turn_s: float = 0.0
    """shortest turn of the expert"""
    quiet_s: float = 0.0
    """time without an alarm before the expert hands back"""
    a_minute: int = 0
    """requests in any 60 s, at most: after the last the expert drives until another may come; 0: no
    limit"""
    an_episode: int = 0
    """requests in an episode, at most: after the last the expert drives to its end; 0: no limit"""

    def __post_init__(self) -> None:
        for name in ("turn_s", "quiet_s", "a_minute", "an_episode"):
            if not getattr(self, name) >= 0:
                raise ParameterError(f"{name} is {getattr(self, name)}; wanted at least 0")

    @property
    def limits(self) -> bool:
        """Whether any of it is set."""
        return self != RequestConfig()


class PatientGate:
    """Another gate, whose expert hands back only where that spares requests.

    Time is that of the observations, so that it does not depend on how fast they come.
    """

    def __init__(self, gate: Gate, config: RequestConfig) -> None:
        """Store the gate that says where the policy may act, and the limits."""
        self.gate = gate
        self.config = config
        self._forget()

    def reset(self, rng: np.random.Generator) -> None:
        """Forget the last episode: requests of it do not count in the next."""
        self.gate.reset(rng)
        self._forget()

    def decide(self, observation: Observation, proposal: Proposal | None) -> GateDecision:
        """Decide as the gate does, but hand back late."""
        decision, now_s = self.gate.decide(observation, proposal), observation.time_s
        if decision.actor is not Actor.POLICY:
            if self._since_s is None:
                self._since_s = now_s
                self._requests_s.append(now_s)
            self._quiet_since_s = None
            return decision
        if self._since_s is None:
            return decision
        if self._quiet_since_s is None:
            self._quiet_since_s = now_s
        reason = self._in_the_way(now_s, self._since_s, self._quiet_since_s)
        if reason is None:
            self._since_s = None
            return decision
        return replace(decision, actor=Actor.EXPERT, query=True, reason=reason)

    def _in_the_way(self, now_s: float, since_s: float, quiet_since_s: float) -> Reason | None:
        """Why the expert does not hand back; None where it does."""
        config = self.config
        if now_s - since_s < config.turn_s - ROUNDING_S:
            return Reason.HOLD
        if now_s - quiet_since_s < config.quiet_s - ROUNDING_S:
            return Reason.HOLD
        if config.an_episode and len(self._requests_s) >= config.an_episode:
            return Reason.SPARED
        # The next alarm may come at once, and would be a request.
        lately = sum(now_s - at_s < MINUTE_S - ROUNDING_S for at_s in self._requests_s)
        return Reason.SPARED if config.a_minute and lately >= config.a_minute else None

    def _forget(self) -> None:
        self._since_s: float | None = None
        self._quiet_since_s: float | None = None
        self._requests_s: list[float] = []
