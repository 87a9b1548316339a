"""A simulation that cannot hold stands still instead, and ends where nobody is left to wait for."""

from collections.abc import Callable, Mapping

import numpy as np
import pytest

from sheath_manip.cockpit import (
    Cockpit,
    OperatedEnvironment,
    Order,
    PersonGate,
    beside_the_policy,
)
from sheath_manip.cockpit.shown import Shown
from sheath_manip.exceptions import UnattendedError
from sheath_manip.gates import AlwaysExpert, AlwaysPolicy
from sheath_manip.protocols import Expert, Gate
from sheath_manip.rollout.loop import rollout
from sheath_manip.types import Actor, Episode, Outcome, Reason
from tests.cockpit.clock import Clock
from tests.cockpit.operated_corridor import INFO, STRAIGHT, Page, outside_between, reasons, take
from tests.toy import Corridor, MiddleKeeper, teleop

pytestmark = pytest.mark.usefixtures("wide_corridor")


def test_a_simulation_that_cannot_hold_stands_still():
    """Nothing is recorded while it does; the wait is one of the clock then."""

    class Passing(Clock):
        """Half a second at each look."""

        def __call__(self) -> float:
            self.s += 0.25
            return self.s

    cockpit = Cockpit(teleop(Corridor()).guide, Passing())
    environment = Corridor()
    gate = PersonGate(outside_between(3, 6), cockpit, 50.0, wait_s=2.0, can_hold=False)
    episode = rollout(
        OperatedEnvironment(environment, cockpit),
        INFO,
        gate,
        rng=np.random.default_rng(0),
        policy=STRAIGHT,
        others=without_hold(cockpit, environment),
    )
    assert reasons(episode)[3:6] == [Reason.NO_ANSWER] * 3
    assert len(episode) == 12


def without_hold(cockpit: Cockpit, environment: Corridor) -> Mapping[Actor, Expert]:
    """Who may act where the simulation cannot hold: what holds it is never asked."""
    scripted = MiddleKeeper(environment)
    return beside_the_policy(cockpit, teleop(environment), hold=scripted, fallback=scripted)


class Impatient(Cockpit):
    """Does `script` at each look, instead of waiting for news."""

    script: Callable[[Cockpit], object] = staticmethod(lambda _: None)

    def rest(self) -> float:
        self.script(self)
        return 0.01


def cannot_hold(
    gate: Gate, before: Callable[[Cockpit], object], meanwhile, wait_s=0.0, wrap=True
) -> Episode:
    """A run of a simulation that cannot hold; `before` is done once it goes, `meanwhile` then."""
    cockpit = Impatient(teleop(Corridor()).guide, Clock())
    cockpit.script = meanwhile
    environment = Corridor()
    person = PersonGate(gate, cockpit, 50.0, wait_s=wait_s, can_hold=False, dead_man=False)
    try:
        return rollout(
            OperatedEnvironment(environment, cockpit),
            INFO,
            person if wrap else gate,
            rng=np.random.default_rng(0),
            policy=STRAIGHT,
            others=without_hold(cockpit, environment),
            listeners=(Page(cockpit, Clock(), {4: before}),),
        )
    finally:
        assert environment.done == 4 or not cockpit.state.stopped


@pytest.mark.parametrize("wrap", [True, False], ids=["person's gate", "bare gate"])
@pytest.mark.parametrize(
    ("before", "why"),
    [
        (lambda page: page.order(Order.STOP, "page"), "emergency stop"),
        (lambda page: (take(page), page.leave("page")), "lost"),
    ],
)
def test_what_cannot_hold_ends_the_run_where_nobody_is_left_to_say_how_to_go_on(before, why, wrap):
    with pytest.raises(UnattendedError, match=why):
        cannot_hold(AlwaysPolicy(), before, Cockpit.close, wrap=wrap)


@pytest.mark.parametrize("wrap", [True, False], ids=["person's gate", "bare gate"])
def test_what_cannot_hold_takes_no_last_step_after_a_stop(wrap):
    episode = cannot_hold(
        AlwaysPolicy(),
        lambda page: page.order(Order.STOP, "page"),
        lambda page: page.order(Order.SAVE, "page"),
        wrap=wrap,
    )
    assert episode.truncated
    assert not episode.terminated
    np.testing.assert_array_equal(episode.final_state, episode.steps[-1].state)


@pytest.mark.parametrize("wrap", [True, False], ids=["person's gate", "bare gate"])
def test_what_cannot_hold_goes_on_after_reset_and_resume(wrap):
    def reset(page: Cockpit) -> None:
        page.order(Order.RESET, "page", shown=Shown(stops=page.state.stops))
        page.order(Order.RESUME, "page", shown=Shown(stops=page.state.stops))

    episode = cannot_hold(
        AlwaysPolicy(), lambda page: page.order(Order.STOP, "page"), reset, wrap=wrap
    )
    assert len(episode) == 12
    assert episode.outcome is Outcome.SUCCESS


@pytest.mark.parametrize(("wait_s", "ends"), [(100.0, False), (float("inf"), True)])
def test_a_wait_that_is_in_vain_ends(wait_s, ends):
    """The fallback acts at once where it was to act anyway; where it never was, the run ends."""
    if ends:
        with pytest.raises(UnattendedError, match="as long as it takes"):
            cannot_hold(AlwaysExpert(), lambda _: None, Cockpit.close, wait_s)
    else:
        episode = cannot_hold(AlwaysExpert(), lambda _: None, Cockpit.close, wait_s)
        assert set(reasons(episode)) == {Reason.NO_ANSWER}
