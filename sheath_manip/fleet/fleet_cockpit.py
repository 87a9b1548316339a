"""The person's side of several robots: one who drives at a time, one queue, one stop for all.

Each robot has a cockpit of its own in its process, and the last word on whether it moves. This one
says who of those at the page may drive, and passes on what that one does to the robot shown.
"""

import threading
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sheath_manip.cockpit import Cockpit, OperatorInput, Order, SixAxes
from sheath_manip.cockpit.between import Pastime
from sheath_manip.cockpit.orders import OF_ANY_RUN
from sheath_manip.cockpit.shown import NOTHING, Shown
from sheath_manip.cockpit.standing import Standing
from sheath_manip.cockpit.state import State
from sheath_manip.fleet.from_robot import FromRobot
from sheath_manip.fleet.outbox import Outbox
from sheath_manip.fleet.roster import Roster
from sheath_manip.fleet.seat import Seat
from sheath_manip.fleet.to_robot import Closed, Dragged, Gone, Held, Ordered, Silenced, Turned
from sheath_manip.fleet.urgency import PATIENCE_S
from sheath_manip.playback.film import Film
from sheath_manip.types import Actor
from sheath_manip.types.operator_input import Binding

_OF_ALL = (Order.STOP, Order.RESET, *OF_ANY_RUN)


class FleetCockpit(Cockpit):
    """One cockpit for the page: that of the robot shown, which is the one that is served.

    A stop, a reset, a pause and the pace are of all robots. Times are of `time.monotonic`.
    """

    def __init__(
        self,
        robots: int,
        guide: tuple[Binding, ...],
        fallback: str,
        planar: bool = False,
        patience_s: float = PATIENCE_S,
    ) -> None:
        """Begin with so many robots, of none of which anything is known."""
        super().__init__(guide, paced=True, fallback=fallback, planar=planar)
        self.roster = Roster(robots, patience_s, self._clock, self._adopt)
        self.on_film: Callable[[Film], None] = lambda _: None
        """called with the episode to be shown; returns at once"""
        self._at_desk = threading.RLock()
        """held while an order or a report is taken: what robots are told is in one order"""
        self._begun = False
        self._last_driver: tuple[str, Seat] | None = None

    # The page's side.
    @property
    def state(self) -> State:
        """The robot that is shown, and what is the same for all."""
        with self._at_desk:
            own, seat, now_s = super().state, self.roster.shown, self._clock()
            shown = own if seat.report is None else seat.report.state
            places = {each.number: place for place, each in enumerate(self.roster.in_turn(), 1)}
            between = shown.between
            if seat.report is None and not seat.finished:
                between = Pastime(int(now_s - seat.since_s), "starting")
            return replace(
                shown,
                operated=own.operated,
                paused=own.paused,
                speed=own.speed,
                stopped=own.stopped,
                stops=own.stops,
                taken=own.taken,
                operator=own.operator,
                over=own.over,
                abandoned=shown.abandoned and seat.report is not None,
                between=None if seat.finished else between,
                fallback=own.fallback,
                robot=seat.number,
                robots=tuple(
                    each.shown(now_s, places.get(each.number, 0)) for each in self.roster.seats
                ),
            )

    @property
    def turn(self) -> Actor:
        """Who acts at the robot that is shown."""
        report = self.roster.shown.report
        return Actor.HOLD if report is None else report.state.turn

    @property
    def true_s(self) -> float:
        """Up to when what is known of the robot that is shown is true."""
        now_s, report = self._clock(), self.roster.shown.report
        return report.at_s if report is not None and self.roster.shown.silent_s(now_s) else now_s

    def order(
        self,
        order: Order,
        station: str | None,
        value: float = 1.0,
        shown: Shown = NOTHING,
    ) -> bool:
        """Do what `station` orders: with all robots, or with the one shown, if it saw that one."""
        with self._at_desk:
            if order in _OF_ALL:
                if not super().order(order, station, value, shown):
                    return False
                for each in self.roster.seats:
                    each.tell(Ordered(order, None, value, shown))
                return True
            if order in (Order.CHOOSE, Order.NEXT):
                return self._choose(order, value)
            elsewhere = shown.robot not in (None, self.roster.shown.number)
            if elsewhere or not (station is None or self.lease.holder in (None, station)):
                return False
            return self._serve(order, station, value, shown)

    def submit_input(self, station: str, operator_input: OperatorInput, age_s: float = 0.0) -> bool:
        """Pass on what the devices of `station` said `age_s` ago; whether it drives."""
        with self._at_desk:
            at_s = self._clock() - age_s
            drives = super().submit_input(station, operator_input, age_s)
            if drives:
                self.roster.shown.tell(Held(station, operator_input, at_s))
            return drives

    def drag(self, station: str, goal: NDArray | None) -> bool:
        """Pass on where `station` drags the gizmo to; whether it drives."""
        with self._at_desk:
            drives = super().drag(station, goal)
            if drives:
                self.roster.shown.tell(Dragged(station, None if goal is None else np.array(goal)))
            return drives

    def turn_axes(self, axes: SixAxes) -> None:
        """Pass on what a device says that is plugged in here."""
        if self.lease.holder is not None:
            self.roster.shown.tell(Turned(axes))

    def silence(self, station: str) -> None:
        """Make nothing that `station` said count any longer."""
        self._without(station, Silenced(station))
        super().silence(station)

    def leave(self, station: str) -> None:
        """`station` is gone: what it drove holds."""
        self._without(station, Gone(station))
        super().leave(station)

    def close(self) -> None:
        """Never wait again, and no robot either."""
        with self._at_desk:
            super().close()
            for each in self.roster.seats:
                each.tell(Closed())

    # The robots' side.
    def attach(self, seat: Seat, outbox: Outbox) -> None:
        """A process is there for that robot; it is told first how the others stand."""
        with self._at_desk:
            standing = self._seen()
            outbox.put(
                Standing(
                    operated=True,
                    stops=standing.stops,
                    cleared=standing.cleared,
                    halted=standing.stopped,
                    paused=standing.paused,
                    speed=standing.speed,
                    closed=standing.closed,
                )
            )
            seat.attach(outbox, self._clock())
        self.on_change()

    def detach(self, seat: Seat) -> None:
        """It is gone, and who drove it drives nothing."""
        with self._at_desk:
            seat.detach()
            self._release(seat)
        self.on_change()

    def hear(self, seat: Seat, message: FromRobot) -> None:
        """Take note of what that robot says, and show another one where it is its turn."""
        with self._at_desk:
            film = seat.film
            seat.hear(message)
            self._let_begin(seat)
            is_shown = seat is self.roster.shown
            if is_shown:
                self._adopt(seat, anew=seat.film is not film)
            self._offer()
        if is_shown:
            self.on_change()

    def finish(self, seat: Seat, finished: bool) -> None:
        """Note whether there is nothing more for that robot to do."""
        with self._at_desk:
            seat.finished, seat.report, seat.since_s = finished, None, self._clock()
            if finished:
                self._release(seat)
        self.on_change()

    # Both, at the desk.
    def _serve(self, order: Order, station: str | None, value: float, shown: Shown) -> bool:
        seat = self.roster.shown
        if order is Order.TAKE_OVER:
            if seat.report is None:
                # It starts: what it is told now it does not hear, or is told otherwise next.
                return False
            last = self._last_driver
            # Its own cockpit may not have noticed yet that it was lost.
            if last is not None and last != (station, seat):
                last[1].tell(Gone(last[0]))
            if station is None or not super().order(order, station, value, shown):
                return False
            self._last_driver = station, seat
        elif order is Order.HAND_BACK:
            super().order(order, station, value, shown)
        if order in (Order.TAKE_OVER, Order.HAND_BACK) and not self._begun:
            self._begun = True
            seat.told_to_begin = order is Order.TAKE_OVER
            for each in self.roster.seats:
                self._let_begin(each)
        seat.tell(Ordered(order, station, value, shown))
        if order is Order.HAND_BACK:
            self.roster.handed_back()
        self.on_change()
        return True

    def _choose(self, order: Order, number: float) -> bool:
        """Show another robot, whether that may be: not while somebody drives the one shown."""
        if self.lease.holder is not None:
            return False
        if order is Order.CHOOSE and not self.roster.choose(number):
            return False
        if order is Order.NEXT:
            self.roster.choose_next()
        self.on_change()
        return True

    def _release(self, seat: Seat) -> None:
        """Who drove that robot is free for the next one."""
        holder = self.lease.holder
        if seat is self.roster.shown and holder is not None:
            super().leave(holder)
        self._offer()

    def _offer(self) -> None:
        # Who has stopped a robot goes on seeing it, whatever the others' last reports ask.
        if self.lease.holder is None and not self._seen().stopped:
            self.roster.offer()

    def _let_begin(self, seat: Seat) -> None:
        """Once somebody at the page has let the run begin, each robot is told so once."""
        waits = seat.report is not None and seat.report.state.unready
        if self._begun and waits and not seat.told_to_begin:
            seat.told_to_begin = True
            seat.tell(Ordered(Order.HAND_BACK, None))

    def _adopt(self, seat: Seat, anew: bool = True) -> None:
        """Have the page see this robot; `anew`: another one than before, or in another episode."""
        report = seat.report
        if anew and seat.film is not None:
            self.on_film(seat.film)
        self.question = seat.question
        self.still = report is not None and report.still
        self.tool_pose = None if report is None else report.tool_pose

    def _without(self, station: str, message: Silenced | Gone) -> None:
        with self._at_desk:
            if self.lease.holder == station:
                self.roster.shown.tell(message)
