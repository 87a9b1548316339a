"""A gate around another one: a person may take over, and is asked where the other one wants it."""

from dataclasses import replace

import numpy as np

from sheath_manip.cockpit.cockpit import Cockpit, Now, Turn
from sheath_manip.exceptions import ParameterError
from sheath_manip.protocols import Gate
from sheath_manip.types import Action, Actor, GateDecision, Observation, Reason

WAIT_S = 10.0
"""for a person, before somebody else acts in its place"""


class PersonGate:
    """The expert is a person: asked where `gate` wants an expert, and free to take over anywhere.

    Robot-gated (SHEATH, LazyDAgger): outside the support the robot holds and asks; nobody there in
    time, the fallback acts until the gate hands back. Human-gated (HG-DAgger): who has taken over
    drives until it hands back. A person who is gone, or lets go of the dead-man, leaves the robot
    holding. The emergency stop is above all of it.

    What is done while nobody drives is no label. A simulation that cannot hold (a car at constant
    speed) stands still instead: `decide` returns when it may go on.
    """

    def __init__(
        self,
        gate: Gate,
        cockpit: Cockpit,
        control_rate_hz: float,
        *,
        wait_s: float = WAIT_S,
        can_hold: bool = True,
        dead_man: bool = True,
        fallback_teaches: bool = True,
    ) -> None:
        """Store who is asked when, and for how long.

        Args:
            gate: wants the expert where it lets the policy not act.
            cockpit: where the person is.
            control_rate_hz: of the task; the wait is counted in control steps.
            wait_s: for the person, before the fallback acts; inf waits for ever.
            can_hold: whether an action leaves the robot where it is.
            dead_man: whether the robot holds while no device is held.
            fallback_teaches: whether what the fallback does is learned from.
        """
        if not wait_s >= 0:
            raise ParameterError(f"wait_s is {wait_s}; wanted at least 0, such as {WAIT_S:g}")
        self.gate = gate
        self.cockpit = cockpit
        self.wait_s = wait_s
        self.can_hold = can_hold
        self.dead_man = dead_man
        self.fallback_teaches = fallback_teaches
        self._period_s = 1 / control_rate_hz
        self._waited_s = 0.0

    def reset(self, rng: np.random.Generator) -> None:
        """A new episode; who drives drives on."""
        self.gate.reset(rng)
        self._waited_s = 0.0

    def decide(self, observation: Observation, proposed: Action | None) -> GateDecision:
        """Ask the gate and the cockpit; blocks only while a simulation cannot hold."""
        wanted = self.gate.decide(observation, proposed)
        turn, reason = self._turn(wanted, self.cockpit.now())
        while turn is Turn.HOLD and self._stands_still():
            rested_s = self.cockpit.rest()
            self._waited_s += rested_s * (reason is Reason.WAITING)
            turn, reason = self._turn(wanted, self.cockpit.now())
        self._waited_s += self._period_s * (reason is Reason.WAITING)
        if turn is Turn.POLICY:
            # Nobody can be asked for a label without driving.
            return replace(wanted, query=False)
        teaches = turn is Turn.PERSON or (turn is Turn.FALLBACK and self.fallback_teaches)
        return GateDecision(Actor.EXPERT, teaches, reason, wanted.score, wanted.threshold)

    def _turn(self, wanted: GateDecision, now: Now) -> tuple[Turn, Reason]:
        turn, reason = self._whose(wanted, now)
        if reason not in (Reason.WAITING, Reason.NO_ANSWER, Reason.EMERGENCY_STOP):
            self._waited_s = 0.0
        asking = reason in (Reason.WAITING, Reason.NO_ANSWER)
        self.cockpit.give_turn(turn, asking, max(0.0, self.wait_s - self._waited_s))
        return turn, reason

    def _whose(self, wanted: GateDecision, now: Now) -> tuple[Turn, Reason]:
        if now.stopped:
            return Turn.HOLD, Reason.EMERGENCY_STOP
        if now.taken and now.given is not None:
            if now.given.held or not self.dead_man:
                return Turn.PERSON, Reason.PERSON
            return Turn.HOLD, Reason.IDLE
        if wanted.actor is Actor.POLICY and not (now.taken or now.abandoned):
            return Turn.POLICY, wanted.reason
        if self._waited_s < self.wait_s:
            return Turn.HOLD, Reason.WAITING
        return Turn.FALLBACK, Reason.NO_ANSWER

    def _stands_still(self) -> bool:
        cockpit = self.cockpit
        return not (self.can_hold or cockpit.closed or cockpit.ending is not None)
