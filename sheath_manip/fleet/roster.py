"""Which robot is shown, and so served, and which one comes next."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sheath_manip.fleet.seat import Seat
from sheath_manip.fleet.urgency import by_urgency

CHOSEN_S = 3.0
"""for which a robot stays shown that a person has chosen, though another one asks"""


class Roster:
    """All robots of a fleet, and the one that is shown.

    While nobody drives, that is the first of the queue: after a hand-back, and where the one shown
    asks nothing. A request that is shown stays so until it is answered or the person chooses
    another robot, whatever comes meanwhile: nobody is to take over one and find it is another.
    """

    def __init__(
        self,
        robots: int,
        patience_s: float,
        clock: Callable[[], float],
        on_shown: Callable[[Seat], Any],
    ) -> None:
        """Begin with the first of so many robots; `on_shown` is called with each one shown."""
        self.seats = tuple(Seat(number) for number in range(1, robots + 1))
        self.shown = self.seats[0]
        self._patience_s = patience_s
        self._clock = clock
        self._on_shown = on_shown
        self._chosen_s = -np.inf

    def queue(self) -> list[Seat]:
        """Return the robots that ask, the most urgent first."""
        now_s = self._clock()
        asked = [request for each in self.seats if (request := each.request(now_s)) is not None]
        return [self.seats[each.number - 1] for each in by_urgency(asked, self._patience_s)]

    def in_turn(self) -> list[Seat]:
        """Return the same as they will be served: the request that is shown comes first."""
        return sorted(self.queue(), key=lambda each: each is not self.shown)

    def pictures(self) -> Mapping[int, NDArray[np.uint8]]:
        """Return what each robot's first camera saw last, by its number."""
        seen = {each.number: each.picture for each in self.seats}
        return {number: image for number, image in seen.items() if image is not None}

    def choose(self, number: float) -> bool:
        """Show the robot of that number; whether there is one."""
        if number not in range(1, len(self.seats) + 1):
            return False
        self._chosen_s = self._clock()
        self.show(self.seats[int(number) - 1])
        return True

    def choose_next(self) -> None:
        """Show the one that asks most urgently beside the one shown, or else its neighbour."""
        others = self._others()
        neighbour = self.seats[self.shown.number % len(self.seats)]
        self.choose((others[0] if others else neighbour).number)

    def handed_back(self) -> None:
        """Show the next request, where there is another one."""
        self._chosen_s = -np.inf
        if others := self._others():
            self.show(others[0])

    def offer(self) -> None:
        """Show the most urgent request, where the person is neither at one nor has just chosen.

        Not to be called while somebody drives.
        """
        now_s, shown = self._clock(), self.shown
        if shown.request(now_s) is not None:
            return
        if now_s - self._chosen_s < CHOSEN_S and not shown.finished:
            return
        queue, runs = self.queue(), [each for each in self.seats if not each.finished]
        if queue:
            self.show(queue[0])
        elif shown.finished and runs:
            self.show(runs[0])

    def show(self, seat: Seat) -> None:
        """Show that robot."""
        self.shown = seat
        self._on_shown(seat)

    def _others(self) -> list[Seat]:
        return [each for each in self.queue() if each is not self.shown]
