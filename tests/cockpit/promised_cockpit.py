"""What a cockpit promises, counted from what the stations did, beside the cockpit itself.

It knows the cockpit's promises, not its code.
"""

import numpy as np
from hypothesis import event

from sheath_manip.cockpit import Cockpit, OperatorInput, Order, PersonGate
from sheath_manip.cockpit.lease import FREE_AFTER_S, LOST_AFTER_S
from sheath_manip.cockpit.shown import Shown
from sheath_manip.exceptions import UnattendedError
from sheath_manip.gates.patient import RequestConfig
from sheath_manip.types import Actor, GateDecision, Observation, Proposal, Reason
from sheath_manip.types.operator_input import Binding
from tests.cockpit.clock import Clock

RATE_HZ = 20.0
KEY = OperatorInput(keys=frozenset({"KeyI"}))
SEEN = Observation({}, np.zeros(1, np.float32), 0.0)
AT_REST = Proposal(np.zeros((1, 1), np.float32))


class StandsStillError(Exception):
    """The loop would wait here."""


class Unwaiting(Cockpit):
    """Raises where it would wait, since here nothing happens meanwhile."""

    def rest(self) -> float:
        raise StandsStillError


class Whim:
    """A gate that wants the actor that it is told to want."""

    actor = Actor.POLICY

    def reset(self, rng) -> None:
        del rng

    def decide(self, observation: Observation, proposal: Proposal | None) -> GateDecision:
        del observation, proposal
        return GateDecision(self.actor, False, Reason.INSIDE)


class PromisedCockpit:
    """One cockpit and one loop: each turn of the loop is held against the promises."""

    def _begin(self, can_hold: bool, wait_s: float) -> None:
        self.clock = Clock()
        self.cockpit = Unwaiting((Binding(("KeyI",), "on"),), self.clock, undo_s=0.0)
        self.can_hold = can_hold
        self.whim = Whim()
        self.gate = PersonGate(
            self.whim,
            self.cockpit,
            RATE_HZ,
            wait_s=wait_s,
            can_hold=can_hold,
            dead_man=True,
            # A robot, which is held step by step, and asks at each alarm.
            stands_still=False,
            requests=RequestConfig(),
        )
        # What is so, by what the stations did.
        self.stops = 0
        self.stopped = self.lost = self.waits = False
        self.free = True
        # Single steps after a stop: ordered, let on with, and whether there was one at all.
        self.ordered, self.granted, self.stepped = 0, False, False
        self.driver: str | None = None
        self.heard_s = 0.0
        self.held: OperatorInput | None = None
        self.closed = self.ended = False
        self._episode()

    def _episode(self) -> None:
        self.cockpit.begin_episode()
        self.gate.reset(np.random.default_rng(0))
        self.ended = False
        self.steps_done = 0
        self._wait()

    def _wait(self) -> None:
        """As the page's listener does, before the first step and after each."""
        self.waits = True
        try:
            self.cockpit.wait()
        except StandsStillError:
            event("the loop is paused")
            return
        self.waits = False
        if not (self.free or self.stopped or self.closed or self.ended):
            self._grant()

    def _grant(self) -> None:
        assert self.ordered > 0
        self.ordered, self.granted, self.stepped = self.ordered - 1, True, True

    def _step(self) -> None:
        """One turn of the loop, as rollout does it."""
        self._age()
        alive = self.held is not None and self.clock.s - self.heard_s <= LOST_AFTER_S
        if not (self.free or self.stopped or self.granted) and self.ordered and not self.stepped:
            self._grant()
        let_on = self.free or self.granted or (self.stepped and (self.closed or self.ended))
        silent = self.driver is not None and not alive
        must_hold = self.stopped or self.lost or silent or not let_on
        self.granted = False
        decision = ended = None
        try:
            decision = self.gate.decide(SEEN, AT_REST)
        except (StandsStillError, UnattendedError) as error:
            ended = type(error)
            event(ended.__name__)
        if decision is None:
            assert not self.can_hold
            assert self.closed is (ended is UnattendedError)
            assert self.cockpit.turn is Actor.HOLD
            return
        turn = decision.actor
        assert turn is self.cockpit.turn
        # Who drives or stands in teaches; to hold is no label.
        assert decision.query is (turn in (Actor.OPERATOR, Actor.FALLBACK))
        event(f"{turn}, {'stopped' if self.stopped else 'lost' if self.lost else 'else'}")
        if must_hold:
            assert turn is Actor.HOLD
            # And what cannot hold moves not even for one last step.
            assert self.can_hold or self.cockpit.still
        if turn is Actor.OPERATOR:
            assert alive
            assert self.held is KEY
            assert self.cockpit.input.keys == KEY.keys
        if self.driver is not None:
            assert turn in (Actor.OPERATOR, Actor.HOLD)
        self.steps_done += 1
        self.clock.s += 1 / RATE_HZ
        self._age()
        if self.ended:
            self._episode()
        else:
            self._wait()

    def _age(self) -> None:
        if self.driver is not None and self.clock.s - self.heard_s > FREE_AFTER_S:
            self.driver, self.held, self.lost = None, None, True

    def _leave(self, station: str) -> None:
        self._age()
        self.cockpit.leave(station)
        if self.driver == station:
            self.driver, self.held, self.lost = None, None, True

    def _heard(self, kind: str, station: str, what, extra) -> None:
        self._age()
        if kind == "give":
            age_s = self.clock.s - extra
            self.cockpit.submit_input(station, what, age_s)
            if self.driver == station and age_s <= LOST_AFTER_S:
                self.held, self.heard_s = what, extra
        else:
            self.cockpit.order(what, station, shown=Shown(stops=extra))
            self._follow(station, what, extra)

    def _follow(self, station: str, order: Order, seen: int | None) -> None:
        """What the promises make of the order."""
        knows = seen == self.stops
        mine = self.driver in (None, station)
        if order is Order.STOP:
            self.stops += 1
            self.lost = self.lost or self.driver is not None
            self.driver = self.held = None
            self.stopped = True
            self.free, self.ordered, self.granted, self.stepped = False, 0, False, False
        elif not mine:
            pass
        elif order is Order.RESET and self.stopped and knows:
            self.stopped = False
        elif order is Order.RESUME and knows and not self.stopped:
            self.free, self.ordered = True, 0
        elif order is Order.STEP and knows and not (self.stopped or self.free):
            self.ordered += 1
        elif order is Order.PAUSE:
            self.ordered = 0
        elif order is Order.TAKE_OVER and knows and not self.stopped and self.driver is None:
            self.driver, self.lost = station, False
            self.held, self.heard_s = OperatorInput(), self.clock.s
        elif order is Order.HAND_BACK and knows and (self.lost or self.driver == station):
            self.driver, self.held, self.lost = None, None, False
        elif order in (Order.SUCCESS, Order.FAILURE, Order.SAVE, Order.DISCARD):
            self.ended = True
