"""Any sequence of orders, losses, reloads and episodes: no stop is lost, and nothing moves then.

What is expected is counted from what the stations did, in `promised_cockpit`.
`make test` plays a few sequences; SHEATH_COCKPIT_SEQUENCES=10000 plays that many.
"""

import os
from dataclasses import dataclass, field

from hypothesis import HealthCheck, settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, precondition, rule

from sheath_manip.cockpit import OperatorInput, Order
from sheath_manip.cockpit.lease import FREE_AFTER_S, LOST_AFTER_S
from sheath_manip.types import Actor
from tests.cockpit.promised_cockpit import KEY, PromisedCockpit

SEQUENCES = int(os.environ.get("SHEATH_COCKPIT_SEQUENCES", "40"))
PAGES = st.integers(0, 2)


@dataclass
class Page:
    """What one page knows, and what of it is still under way."""

    loads: int = 0
    shown: int = 0
    """the number of stops that it shows"""
    holds: OperatorInput = field(default_factory=OperatorInput)
    under_way: list = field(default_factory=list)
    """calls that the cockpit has not got yet, in their order"""


class CockpitMachine(PromisedCockpit, RuleBasedStateMachine):
    """Three pages, one loop."""

    @initialize(can_hold=st.booleans(), wait_s=st.sampled_from([0.0, 0.2, float("inf")]))
    def begin(self, can_hold: bool, wait_s: float) -> None:
        self.pages = [Page() for _ in range(3)]
        self.fitting = False
        self._begin(can_hold, wait_s)

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

    def _station(self, page: int) -> str:
        return f"page {page}, loaded {self.pages[page].loads} times"

    def _send(self, page: int, late: bool, kind: str, what, extra) -> None:
        self.pages[page].under_way.append((kind, self._station(page), what, extra))
        if not late:
            self.arrive(page)


CockpitMachine.TestCase.settings = settings(
    max_examples=SEQUENCES,
    stateful_step_count=50,
    deadline=None,
    suppress_health_check=(HealthCheck.too_slow, HealthCheck.filter_too_much),
)
TestCockpit = CockpitMachine.TestCase
