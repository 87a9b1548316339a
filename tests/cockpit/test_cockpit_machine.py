"""Any sequence of orders, losses, reloads and episodes: no stop is lost, and nothing moves then.

The machine knows the cockpit's promises, not its code: what it expects is counted from what the
stations did. `make test` plays a few sequences; SHEATH_COCKPIT_SEQUENCES=10000 plays that many.
"""

import os
from dataclasses import dataclass, field

import numpy as np
from hypothesis import HealthCheck, event, settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, precondition, rule

from sheath_manip.cockpit import Cockpit, OperatorInput, Order, PersonGate
from sheath_manip.cockpit.lease import FREE_AFTER_S, LOST_AFTER_S
from sheath_manip.exceptions import UnattendedError
from sheath_manip.types import Actor, GateDecision, Observation, Proposal, Reason
from sheath_manip.types.operator_input import Binding
from tests.cockpit.clock import Clock

SEQUENCES = int(os.environ.get("SHEATH_COCKPIT_SEQUENCES", "40"))
RATE_HZ = 20.0
KEY = OperatorInput(keys=frozenset({"KeyI"}))
SEEN = Observation({}, np.zeros(1, np.float32), 0.0)
AT_REST = Proposal(np.zeros((1, 1), np.float32))
PAGES = st.integers(0, 2)


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


@dataclass
class Page:
    """What one page knows, and what of it is still under way."""

    loads: int = 0
    shown: int = 0
    """the number of stops that it shows"""
    holds: OperatorInput = field(default_factory=OperatorInput)
    under_way: list = field(default_factory=list)
    """calls that the cockpit has not got yet, in their order"""


class CockpitMachine(RuleBasedStateMachine):
    """Three pages, one loop."""

    @initialize(can_hold=st.booleans(), wait_s=st.sampled_from([0.0, 0.2, float("inf")]))
    def begin(self, can_hold: bool, wait_s: float) -> None:
        self.clock = Clock()
        self.cockpit = Unwaiting((Binding(("KeyI",), "on"),), self.clock)
        self.can_hold = can_hold
        self.whim = Whim()
        self.gate = PersonGate(
            self.whim, self.cockpit, RATE_HZ, wait_s=wait_s, can_hold=can_hold, dead_man=True
        )
        self.pages = [Page() for _ in range(3)]
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
        self.fitting = False
        self._episode()

    # What pages do: it arrives at once, or later.

    @rule(page=PAGES, order=st.sampled_from(list(Order)), late=st.booleans())
    def order(self, page: int, order: Order, late: bool) -> None:
        self._send(page, late, "order", order, self.pages[page].shown)

    @rule(page=PAGES, late=st.booleans())
    def stop(self, page: int, late: bool) -> None:
        self._send(page, late, "order", Order.STOP, self.pages[page].shown)

    @rule(page=PAGES, late=st.booleans())
    def in_one_breath(self, page: int, late: bool) -> None:
        for order in (Order.STOP, Order.RESET, Order.RESUME, Order.STOP):
            self._send(page, late, "order", order, self.pages[page].shown)

    @rule(page=PAGES)
    def look_reset_and_resume(self, page: int) -> None:
        self.look(page)
        for order in (Order.RESET, Order.RESUME):
            self._send(page, False, "order", order, self.pages[page].shown)

    @rule(page=PAGES, times=st.integers(0, 3))
    def stop_look_and_reset(self, page: int, times: int) -> None:
        """Which leaves the run paused, so that only so many steps move."""
        self._send(page, False, "order", Order.STOP, 0)
        self.look(page)
        self._send(page, False, "order", Order.RESET, self.pages[page].shown)
        for _ in range(times):
            self._send(page, False, "order", Order.STEP, self.pages[page].shown)
        if not self.fitting:
            self.step(3)

    @rule(page=PAGES, seen=st.one_of(st.none(), st.integers(0, 5)))
    def guess(self, page: int, seen: int | None) -> None:
        """A program that makes numbers up; one that it happens to know it may use."""
        if seen != self.stops:
            self._send(page, False, "order", Order.RESET, seen)

    @rule(page=PAGES, times=st.integers(1, 4))
    def drive(self, page: int, times: int) -> None:
        """Whatever it takes, as far as it may; then the loop goes on."""
        self.look_reset_and_resume(page)
        self._send(page, False, "order", Order.TAKE_OVER, self.pages[page].shown)
        self._go_on(page, KEY, times)

    @rule(page=PAGES, times=st.integers(1, 4))
    def let_the_policy_go_on(self, page: int, times: int) -> None:
        self.look_reset_and_resume(page)
        self._send(page, False, "order", Order.HAND_BACK, self.pages[page].shown)
        self._go_on(page, OperatorInput(), times)

    def _go_on(self, page: int, given: OperatorInput, times: int) -> None:
        self.fitting = False
        for _ in range(times):
            self._send(page, False, "give", given, self.clock.s)
            self.step(1)

    @rule(page=PAGES, late=st.booleans(), held=st.booleans())
    def hold(self, page: int, late: bool, held: bool) -> None:
        self._send(page, late, "give", KEY if held else OperatorInput(), self.clock.s)

    @rule(page=PAGES)
    def look(self, page: int) -> None:
        self.pages[page].shown = self.cockpit.state.stops

    @rule(page=PAGES)
    def arrive(self, page: int) -> None:
        for call in self.pages[page].under_way:
            self._heard(*call)
        self.pages[page].under_way.clear()

    @rule(page=PAGES)
    def reload(self, page: int) -> None:
        """The page is another station from now on, which knows nothing until it looks."""
        self._leave(self._station(page))
        self.pages[page] = Page(self.pages[page].loads + 1)

    @rule(page=PAGES)
    def silence(self, page: int) -> None:
        """Its socket closes, or says too much."""
        station = self._station(page)
        self.cockpit.silence(station)
        if self.driver == station:
            self.held = None

    @rule(passed_s=st.sampled_from([0.01, 0.1, LOST_AFTER_S + 0.01, FREE_AFTER_S + 0.01]))
    def time_passes(self, passed_s: float) -> None:
        self.clock.s += passed_s

    # What the run does.

    @rule()
    def fit(self) -> None:
        """From here until the next episode the loop looks at nothing."""
        self.fitting = True

    @rule()
    def episode(self) -> None:
        self.fitting = False
        self._episode()

    @rule(actor=st.sampled_from(Actor))
    def gate_wants(self, actor: Actor) -> None:
        self.whim.actor = actor

    @precondition(lambda self: self.steps_done > 5)
    @rule()
    def close_the_page(self) -> None:
        self.cockpit.close()
        self.closed = True

    @precondition(lambda self: not self.fitting)
    @rule(times=st.integers(1, 3))
    def step(self, times: int) -> None:
        for _ in range(times):
            if self.waits:
                self._wait()
            if not self.waits:
                self._step()

    @invariant()
    def no_stop_is_lost(self) -> None:
        if hasattr(self, "pages"):
            assert self.cockpit.state.stopped == self.stopped
            assert self.cockpit.state.stops == self.stops

    @invariant()
    def only_one_drives_and_it_is_who_took_over(self) -> None:
        if hasattr(self, "pages"):
            self._age()
            assert self.cockpit.state.operator == self.driver
            assert self.cockpit.state.abandoned == self.lost

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

    def _station(self, page: int) -> str:
        return f"page {page}, loaded {self.pages[page].loads} times"

    def _send(self, page: int, late: bool, kind: str, what, extra) -> None:
        self.pages[page].under_way.append((kind, self._station(page), what, extra))
        if not late:
            self.arrive(page)

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
            self.cockpit.order(what, station, seen=extra)
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


CockpitMachine.TestCase.settings = settings(
    max_examples=SEQUENCES,
    stateful_step_count=50,
    deadline=None,
    suppress_health_check=(HealthCheck.too_slow, HealthCheck.filter_too_much),
)
TestCockpit = CockpitMachine.TestCase
