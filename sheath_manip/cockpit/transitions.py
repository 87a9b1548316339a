"""What each order makes of how things stand: pure functions, applied at once and one at a time.

Nothing waits in a queue, so no order can overtake another one. An order to move that comes of a
page which has not seen the newest emergency stop is void, however long it was under way, and so is
one to end an episode that is over.
"""

from dataclasses import replace

from numpy.typing import NDArray

from sheath_manip.cockpit.lease import NOBODY, Lease
from sheath_manip.cockpit.orders import OF_ANY_RUN, Order, clamped_speed
from sheath_manip.cockpit.shown import NOTHING, Shown
from sheath_manip.cockpit.standing import Ending, Standing
from sheath_manip.types.operator_input import OperatorInput

MOST_STEPS = 64
"""single ones that a paused run may still have to do"""
_ENDINGS = {
    Order.SUCCESS: Ending.SUCCESS,
    Order.FAILURE: Ending.FAILURE,
    Order.SAVE: Ending.SAVE,
}
UNDO_S = 5.0
"""in which a discard may be called off"""


def follow(
    standing: Standing,
    order: Order,
    station: str | None,
    now_s: float,
    value: float = 1.0,
    shown: Shown = NOTHING,
    undo_s: float = UNDO_S,
) -> Standing | None:
    """Return how things stand once `station` has ordered that; None where it may not.

    `station` is None for the program itself, which nobody locks out. `value` goes with a speed, and
    `undo_s` is the time in which a discard may be called off.
    """
    if order is Order.STOP:
        return _stopped(standing) if standing.operated else None
    if not _may(standing, order, station, shown):
        return None
    if order in _ENDINGS:
        return replace(standing, ending=_ENDINGS[order], discard_at_s=None)
    match order:
        case Order.RESET:
            return replace(standing, cleared=standing.stops, paused=True, steps=0)
        case Order.TAKE_OVER if station is not None and station != standing.lease.holder:
            return replace(standing, lease=Lease.begun(station, now_s), abandoned=False)
        case Order.HAND_BACK:
            return replace(standing, lease=NOBODY, abandoned=False)
        case Order.PAUSE | Order.RESUME:
            return replace(standing, paused=order is Order.PAUSE, steps=0)
        case Order.STEP:
            return replace(standing, steps=min(standing.steps + 1, MOST_STEPS))
        case Order.SPEED:
            return replace(standing, speed=clamped_speed(value))
        case Order.DISCARD if standing.discard_at_s is None and standing.ending is None:
            return aged(replace(standing, discard_at_s=now_s + undo_s), now_s)
        case Order.CALL_OFF:
            return replace(standing, discard_at_s=None)
        case _:
            return standing


def _stopped(standing: Standing) -> Standing:
    # Who drove has to take over anew: neither its held key nor the policy goes on by itself.
    return replace(
        standing,
        stops=standing.stops + 1,
        halted=True,
        steps=0,
        lease=NOBODY,
        abandoned=standing.abandoned or standing.taken,
    )


def _may(standing: Standing, order: Order, station: str | None, shown: Shown) -> bool:
    if station is not None and standing.lease.holder not in (None, station):
        return False
    if not standing.operated and order not in OF_ANY_RUN:
        return False
    behind = shown.stops not in (None, standing.stops)
    match order:
        case Order.RESET:
            return standing.stopped and shown.stops == standing.stops
        case Order.HAND_BACK:
            return not behind and (standing.taken or standing.abandoned)
        case Order.RESUME | Order.TAKE_OVER:
            return not (behind or standing.stopped)
        case Order.STEP:
            return standing.paused and not (behind or standing.stopped)
        case Order.CALL_OFF:
            return standing.discard_at_s is not None
        case Order.SUCCESS | Order.FAILURE | Order.SAVE | Order.DISCARD:
            # One that ended by itself in that moment is over; the next has hardly begun.
            return shown.episode in (None, standing.episodes)
        case _:
            return True


def aged(standing: Standing, now_s: float) -> Standing:
    """Return how things stand at `now_s`: who is not heard of for too long is lost."""
    if standing.discard_at_s is not None and now_s >= standing.discard_at_s:
        standing = replace(standing, ending=Ending.DISCARD, discard_at_s=None)
    return lost(standing) if standing.lease.expired(now_s) else standing


def lost(standing: Standing) -> Standing:
    """Who drove is gone without handing back."""
    return replace(standing, lease=NOBODY, abandoned=True)


def left(standing: Standing, station: str) -> Standing | None:
    """`station` is gone; None where it did not drive."""
    return lost(standing) if standing.lease.holder == station else None


def heard(
    standing: Standing, station: str, operator_input: OperatorInput, at_s: float
) -> Standing | None:
    """`station` said at `at_s` what it holds; None where it does not drive."""
    if standing.lease.holder != station:
        return None
    return replace(standing, lease=standing.lease.heard(operator_input, at_s))


def dragged(standing: Standing, station: str, goal: NDArray | None) -> Standing | None:
    """`station` drags the gizmo to `goal`; None where it does not drive."""
    if standing.lease.holder != station:
        return None
    return replace(standing, lease=replace(standing.lease, goal=goal))


def silenced(standing: Standing, station: str) -> Standing | None:
    """Return a state in which nothing that `station` said counts; None where nothing did."""
    if standing.lease.holder != station or standing.lease.input is None:
        return None
    return replace(standing, lease=standing.lease.silenced())


def let_on(standing: Standing) -> Standing | None:
    """The loop goes on with its next step; None where it may not.

    That is while the run is paused, and while a discard may still be called off.
    """
    if standing.discard_at_s is not None or (standing.paused and not standing.steps):
        return None
    return replace(
        standing,
        steps=standing.steps - 1 if standing.paused else 0,
        halted=standing.stopped,
    )


def begun(standing: Standing) -> Standing:
    """A new episode; who drives goes on with the next key, and who is lost or stopped stays so."""
    lease = standing.lease.untouched()
    return replace(
        standing,
        episodes=standing.episodes + 1,
        ending=None,
        discard_at_s=None,
        lease=lease,
    )
