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

    They delay the hand-back. An alarm always takes the wheel from the policy, and who is asked too
    often keeps it.
    """

    turn_s: float = 0.0
    """shortest turn of the expert, before which no other request can come"""
    quiet_s: float = 0.0
    """time without an alarm, the expert's hand still on it, before it hands back: alarms that are
    closer together are one request"""
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


FOR_PEOPLE = RequestConfig(turn_s=2.0, quiet_s=1.0, a_minute=3, an_episode=6)
"""what a person can live with: time to see what is wrong and to put it right, and rest between two
requests; three in any minute are at most four a minute in the mean of three minutes"""


class PatientGate:
    """Another gate, whose expert hands back only where that spares requests.

    Time is that of the observations, so that it does not depend on how fast they come.
    """

    def __init__(self, gate: Gate, config: RequestConfig, session: bool = False) -> None:
        """Store the gate that says where the policy may act, and the limits.

        In a `session` episodes follow each other before one and the same person: requests of
        earlier ones count in the minute, and a turn goes on in the next episode. Else each episode
        is the first.
        """
        self.gate = gate
        self.config = config
        self.session = session
        self.counts = True
        """whether an alarm asks anybody: who drives already is asked nothing"""
        self._before_s = 0.0
        """of the session, when the episode began"""
        self._now_s = 0.0
        self._forget()

    def reset(self, rng: np.random.Generator) -> None:
        """Begin an episode."""
        self.gate.reset(rng)
        if self.session:
            self._before_s, self._quiet_since_s = self._now_s, None
            self._in_episode = 0
        else:
            self._forget()

    def release(self) -> None:
        """Note that the expert has handed back, whatever spares requests: alarms still count."""
        self._since_s = None

    def decide(self, observation: Observation, proposal: Proposal | None) -> GateDecision:
        """Decide as the gate does, but hand back late."""
        decision = self.gate.decide(observation, proposal)
        self._now_s = now_s = self._before_s + observation.time_s
        if decision.actor is not Actor.POLICY:
            self._quiet_since_s = None
            if self._since_s is not None:
                return decision
            if decision.reason is Reason.HOLD:
                # No alarm, and who drove has handed back.
                return replace(decision, actor=Actor.POLICY, query=False, reason=Reason.PERSON)
            if self.counts and self._spent(now_s):
                return replace(decision, actor=Actor.EXPERT, query=True, reason=Reason.SPARED)
            self._since_s = now_s
            if self.counts:
                self._requests_s.append(now_s)
                self._in_episode += 1
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
        # The next alarm may come at once, and would be a request.
        return Reason.SPARED if self._spent(now_s) else None

    def _spent(self, now_s: float) -> bool:
        """Whether nobody may be asked any more, for now."""
        config = self.config
        if config.an_episode and self._in_episode >= config.an_episode:
            return True
        lately = sum(now_s - at_s < MINUTE_S - ROUNDING_S for at_s in self._requests_s)
        return bool(config.a_minute) and lately >= config.a_minute

    def _forget(self) -> None:
        self._since_s: float | None = None
        self._quiet_since_s: float | None = None
        self._requests_s: list[float] = []
        self._in_episode = 0
