"""What page and control loop share: the page queues orders and input, the loop drains them."""

import threading
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from sheath_manip.cockpit.given import EMPTY, Given, SixAxes
from sheath_manip.cockpit.guide import Binding
from sheath_manip.cockpit.lease import LOST_AFTER_S, Lease
from sheath_manip.cockpit.orders import OF_ANY_RUN, Order, clamped_speed
from sheath_manip.types import Outcome

MOST_ORDERS = 64
"""waiting: a page cannot fill the memory of a run that stands still"""
_GLANCE_S = 0.02
"""between two looks at the orders while the run stands still"""


class Turn(StrEnum):
    """Who acts in a step."""

    POLICY = "policy"
    PERSON = "person"
    HOLD = "hold"
    FALLBACK = "fallback"


class Ending(StrEnum):
    """How a person ends an episode."""

    SUCCESS = "success"
    FAILURE = "failure"
    SAVE = "save"
    DISCARD = "discard"


_ENDINGS = {
    Order.SUCCESS: Ending.SUCCESS,
    Order.FAILURE: Ending.FAILURE,
    Order.SAVE: Ending.SAVE,
    Order.DISCARD: Ending.DISCARD,
}
_MARKS = {Ending.SUCCESS: Outcome.SUCCESS, Ending.FAILURE: Outcome.FAILURE}


@dataclass(frozen=True, eq=False)
class Now:
    """What the control loop goes by in one step."""

    stopped: bool
    taken: bool
    """whether a person has taken over"""
    given: Given | None
    """of the operator; None where nobody was heard of for too long"""
    abandoned: bool = False
    """whether who had taken over is gone without handing back"""


@dataclass(frozen=True)
class State:
    """What the page shows of the cockpit."""

    operated: bool
    """whether a person may drive this run at all"""
    paused: bool = False
    speed: float = 1.0
    stopped: bool = False
    taken: bool = False
    turn: Turn = Turn.POLICY
    asking: bool = False
    """whether the robot waits for a person"""
    left_s: float = 0.0
    """until somebody else acts in the person's place"""
    operator: str | None = None
    """the station that drives"""
    stand_in: str = "stand-in"
    """who acts where nobody comes, in words"""


class Cockpit:
    """Takes what a person orders and does, and hands it to the control loop step by step.

    The page's side may be called from any thread and returns at once. The loop's side belongs to
    the thread of the control loop.
    """

    def __init__(
        self,
        guide: tuple[Binding, ...] = (),
        clock: Callable[[], float] = time.monotonic,
        paced: bool = False,
        stand_in: str = State.stand_in,
        planar: bool = False,
    ) -> None:
        """Begin with a run that goes on, at the task's own pace.

        Args:
            guide: the keys by which a person drives; without any the run may only be held.
            clock: seconds that never go back.
            paced: whether the loop keeps to `speed`.
            stand_in: who acts where a person is asked and does not come, in words.
            planar: whether what a gizmo moves stays level and at its height.
        """
        self.guide = guide
        self.paced = paced
        self.planar = planar
        self.on_change: Callable[[], None] = lambda: None
        """called on the loop's thread where there is something new to show; returns at once"""
        self.lease = Lease(clock)
        self._clock = clock
        self._news = threading.Condition()
        self._stop = threading.Event()
        self._orders: deque[tuple[Order, float]] = deque()
        self._given = EMPTY
        self._goal: NDArray[np.float64] | None = None
        self._axes: tuple[float, SixAxes] | None = None
        self._closed = False
        self._state = State(operated=bool(guide), stand_in=stand_in)
        self._steps = 0
        self._abandoned = False
        self.given = EMPTY
        """what the person's devices said in this step"""
        self.ending: Ending | None = None
        """how the person ends the episode, once it was said"""
        self.tool_pose: NDArray[np.float64] | None = None
        """(7,) position (m) and wxyz quaternion, world frame, where the robot has a tool"""

    # The page's side.

    @property
    def state(self) -> State:
        """As it is now."""
        return replace(self._state, stopped=self._stop.is_set(), operator=self.lease.holder)

    @property
    def paused(self) -> bool:
        """Whether the person holds the run, or has ordered to just now."""
        with self._news:
            last = [o for o, _ in self._orders if o in (Order.PAUSE, Order.RESUME)]
            return self._state.paused if not last else last[-1] is Order.PAUSE

    @property
    def heard(self) -> Given:
        """What the operator's page said last."""
        return self._given

    def order(self, order: Order, station: str, value: float = 1.0) -> bool:
        """Queue what `station` orders; whether it may.

        While somebody drives only that one gives orders, but for the emergency stop.
        """
        operated = self._state.operated
        if order is Order.STOP and operated:
            self._stop.set()
            self._wake()
            return True
        holder = self.lease.holder
        if order is Order.TAKE_OVER:
            allowed = operated and self.lease.take(station)
            if allowed and holder != station:
                self._given, self._goal = EMPTY, None
        elif order is Order.HAND_BACK:
            allowed = operated and holder == station
        else:
            allowed = holder in (None, station) and (operated or order in OF_ANY_RUN)
        allowed = allowed and self._queue(order, value)
        if order is Order.HAND_BACK:
            self.lease.release(station)
        return allowed

    def give(self, station: str, given: Given) -> bool:
        """Take what the devices of `station` say, which is a heartbeat too; whether it drives."""
        drives = self.lease.beat(station)
        if drives:
            self._given = given
        return drives

    def drag(self, station: str, goal: NDArray | None) -> bool:
        """Take where `station` drags the gizmo to, (7,), or None once it lets go of it."""
        drives = self.lease.holder == station
        if drives:
            self._goal = None if goal is None else np.array(goal, np.float64)
        return drives

    def turn_axes(self, axes: SixAxes) -> None:
        """Take what a device says that is plugged in here; it drives where a station does."""
        self._axes = (self._clock(), axes)

    def leave(self, station: str) -> None:
        """`station` is gone."""
        self.lease.release(station)
        self._wake()

    # For whoever runs the loop, by program.

    def pause(self) -> None:
        """Hold the run at its next step."""
        self._queue(Order.PAUSE)

    def resume(self) -> None:
        """Let it go on."""
        self._queue(Order.RESUME)

    def close(self) -> None:
        """Never wait again."""
        self._closed = True
        self._wake()

    # The loop's side.

    def begin_episode(self) -> None:
        """Forget how the last one was ended; who drives drives on."""
        self._drain()
        self.ending = None
        self._abandoned = False
        self.give_turn(Turn.POLICY)

    @property
    def mark(self) -> Outcome | None:
        """What the person said the episode is, if anything."""
        return None if self.ending is None else _MARKS.get(self.ending)

    @property
    def speed(self) -> float:
        """Times the task's own pace."""
        return self._state.speed

    @property
    def turn(self) -> Turn:
        """Who acts in this step."""
        return self._state.turn

    def now(self) -> Now:
        """Drain the queue: what this step goes by."""
        self._drain()
        given = self._everything() if self.lease.alive else None
        self.given = given or EMPTY
        return Now(self._stop.is_set(), self._state.taken, given, self._abandoned)

    def give_turn(self, turn: Turn, asking: bool = False, left_s: float = 0.0) -> None:
        """Say who acts in this step, and whether the robot asks for a person."""
        before = self._state
        self._state = replace(before, turn=turn, asking=asking, left_s=left_s)
        if (before.turn, before.asking) != (turn, asking):
            self.on_change()

    def wait(self) -> None:
        """Return at once, or as soon as the run may go on."""
        self._drain()
        while self._state.paused and not self._closed and self.ending is None:
            if self._steps > 0:
                self._steps -= 1
                return
            self.rest()
            self._drain()

    def rest(self) -> float:
        """Wait for news, but not for long; seconds that it took."""
        began_s = self._clock()
        with self._news:
            if not self._orders:
                self._news.wait(_GLANCE_S)
        return self._clock() - began_s

    @property
    def closed(self) -> bool:
        """Whether the page is gone, so that nobody will ever answer."""
        return self._closed

    def _drain(self) -> None:
        with self._news:
            orders = list(self._orders)
            self._orders.clear()
        for order, value in orders:
            self._follow(order, value)
        if self._state.taken and self.lease.holder is None:
            self._change(taken=False)
            self._abandoned = True

    def _follow(self, order: Order, value: float) -> None:
        if order in _ENDINGS:
            self.ending = _ENDINGS[order]
        elif order is Order.SPEED:
            self._change(speed=clamped_speed(value))
        elif order is Order.STEP:
            self._steps += self._state.paused
        elif order in (Order.PAUSE, Order.RESUME):
            self._change(paused=order is Order.PAUSE)
            self._steps = 0
        elif order in (Order.TAKE_OVER, Order.HAND_BACK):
            self._change(taken=order is Order.TAKE_OVER)
            self._abandoned = False
        elif order is Order.RESET and self._stop.is_set():
            self._stop.clear()
            self._change(paused=True)

    def _everything(self) -> Given:
        axes = None
        # Read once: another thread may put another one there.
        latest = self._axes
        if latest is not None and self._clock() - latest[0] <= LOST_AFTER_S:
            axes = latest[1]
        return replace(self._given, goal=self._goal, axes=axes)

    def _change(self, **what: bool | float) -> None:
        self._state = replace(self._state, **what)  # pyright: ignore[reportArgumentType]
        self.on_change()

    def _queue(self, order: Order, value: float = 1.0) -> bool:
        with self._news:
            if len(self._orders) >= MOST_ORDERS:
                return False
            self._orders.append((order, value))
            self._news.notify_all()
            return True

    def _wake(self) -> None:
        with self._news:
            self._news.notify_all()
