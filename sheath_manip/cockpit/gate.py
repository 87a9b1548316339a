"""A gate around another one: a person may take over, and is asked where the other one wants it."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from sheath_manip.cockpit.cockpit import Cockpit
from sheath_manip.cockpit.question import Question
from sheath_manip.cockpit.standing import Now
from sheath_manip.cockpit.unattended import require_attended
from sheath_manip.exceptions import ParameterError
from sheath_manip.gates.patient import FOR_PEOPLE, PatientGate, RequestConfig
from sheath_manip.protocols import Gate
from sheath_manip.rollout.deciding import GuardedGate
from sheath_manip.types import Actor, GateDecision, Observation, Proposal, Reason

WAIT_S = 10.0
"""for a person, before somebody else acts in its place"""


class PersonGate:
    """The expert is a person: asked where `gate` wants an expert, and free to take over anywhere.

    Robot-gated (SHEATH, LazyDAgger): outside the support the robot holds and asks; nobody there in
    time, the fallback acts until the gate hands back. Human-gated (HG-DAgger): who has taken over
    drives until it hands back. Who lets go of the dead-man leaves the robot holding. Who is lost
    without handing back does so too, until somebody takes over or orders the hand-back, in the next
    episode as well: no fallback acts of itself then. The emergency stop is above all of it.

    A person is asked seldom, as `requests` says. Who hands back before it is time for that is not
    asked again but by the next alarm; where that were a request too many the fallback acts.

    Steps in which the robot only holds are not labelled. While a simulation waits for a person it
    stands still, which costs no step; one that cannot hold (a car at constant speed) stands still
    whatever the reason. `decide` returns when it may go on, and raises UnattendedError where the
    page is gone from which somebody could say so.
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
        stands_still: bool = True,
        hold: Callable[[], None] | None = None,
        requests: RequestConfig = FOR_PEOPLE,
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
            stands_still: whether nothing moves between two steps, as in a simulation; a robot is
                held step by step while it waits.
            hold: brings a robot to rest before the loop stands still, where there is one.
            requests: limits on how often the person is asked.
        """
        if not wait_s >= 0:
            raise ParameterError(f"wait_s is {wait_s}; wanted at least 0, such as {WAIT_S:g}")
        # What breaks down or comes late is a request as well, and counted as one.
        self._patient = PatientGate(GuardedGate(gate), requests, session=True)
        self.gate = GuardedGate(self._patient)
        self.cockpit = cockpit
        self.wait_s = wait_s
        self.can_hold = can_hold
        self.dead_man = dead_man
        self.fallback_teaches = fallback_teaches
        self.stands_still = stands_still
        self._hold = hold
        self._period_s = 1 / control_rate_hz
        self._waited_s = 0.0
        self._attended = False
        """whether somebody drove when last looked at, or was lost"""

    def reset(self, rng: np.random.Generator) -> None:
        """A new episode; who drives drives on."""
        self.gate.reset(rng)
        self.cockpit.gated = True
        self._waited_s = 0.0
        if not self._is_attended():
            self._patient.release()

    def decide(self, observation: Observation, proposal: Proposal | None) -> GateDecision:
        """Ask the gate and the cockpit; blocks while a simulation stands still."""
        attended, self._attended = self._attended, self._is_attended()
        if attended and not self._attended:
            self._patient.release()
        # Who has the wheel already is asked nothing.
        self._patient.counts = not self._attended
        wanted = self.gate.decide(observation, proposal)
        self.cockpit.question = _question(observation, proposal, wanted)
        now = self.cockpit.now()
        turn, reason = self._turn(wanted, now)
        stood_s = 0.0
        if self._hold is not None and self._still(turn, reason, now) and now.ending is None:
            self._hold()
        while self._still(turn, reason, now) and now.ending is None:
            require_attended(now)
            rested_s = self.cockpit.rest()
            if reason is Reason.WAITING and not self.cockpit.paused:
                self._waited_s += rested_s
                stood_s += rested_s
            now = self.cockpit.now()
            turn, reason = self._turn(wanted, now)
        self._attended = self._is_attended()
        self._waited_s += self._period_s * (reason is Reason.WAITING)
        if turn is Actor.POLICY:
            # Nobody can be asked for a label without driving.
            return replace(wanted, query=False, waited_s=stood_s)
        teaches = turn is Actor.OPERATOR or (turn is Actor.FALLBACK and self.fallback_teaches)
        return replace(wanted, actor=turn, query=teaches, reason=reason, waited_s=stood_s)

    def _is_attended(self) -> bool:
        state = self.cockpit.state
        return state.taken or state.abandoned

    def _still(self, turn: Actor, reason: Reason, now: Now) -> bool:
        """Whether the step must not be made."""
        if turn is not Actor.HOLD:
            return False
        # Who was lost or stopped must find an arm at rest, as on a robot.
        waits = reason is Reason.WAITING and not now.must_hold and not now.closed
        return not self.can_hold or (self.stands_still and waits)

    def _turn(self, wanted: GateDecision, now: Now) -> tuple[Actor, Reason]:
        turn, reason = self._whose(wanted, now)
        if now.must_hold or reason not in (Reason.WAITING, Reason.NO_ANSWER, Reason.SPARED):
            self._waited_s = 0.0
        asking = reason in (Reason.WAITING, Reason.NO_ANSWER)
        left_s = math.inf if now.must_hold else max(0.0, self.wait_s - self._waited_s)
        still = self._still(turn, reason, now)
        may_go_on = wanted.actor is Actor.POLICY
        self.cockpit.give_turn(turn, asking, left_s, still, may_go_on)
        return turn, reason

    def _whose(self, wanted: GateDecision, now: Now) -> tuple[Actor, Reason]:
        if now.must_hold:
            return Actor.HOLD, Reason.EMERGENCY_STOP if now.halted else Reason.WAITING
        if now.input is not None:
            # Without a dead-man, too, a turn begins with the first key: who has just taken over
            # a car has not got hold of anything yet.
            if now.input.held or (now.touched and not self.dead_man):
                return Actor.OPERATOR, Reason.PERSON
            return Actor.HOLD, Reason.IDLE
        if wanted.actor is Actor.POLICY:
            return Actor.POLICY, wanted.reason
        if wanted.reason is Reason.SPARED:
            return Actor.FALLBACK, Reason.SPARED
        if self._waited_s < self.wait_s and not self._in_vain(now):
            return Actor.HOLD, Reason.WAITING
        return Actor.FALLBACK, Reason.NO_ANSWER

    def _in_vain(self, now: Now) -> bool:
        """Whether to wait is pointless: nobody can come, and no time passes meanwhile."""
        return now.closed and not self.can_hold and math.isfinite(self.wait_s)


def _question(
    observation: Observation, proposal: Proposal | None, wanted: GateDecision
) -> Question | None:
    if wanted.actor is Actor.POLICY:
        return None
    return Question(observation, None if proposal is None else proposal.now[0], wanted)
