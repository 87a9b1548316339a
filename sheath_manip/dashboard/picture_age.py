"""How old the picture is that a page shows, by marks that travel with it and are said back."""

import time
from collections import deque
from collections.abc import Callable

OLDEST_S = 1.0
"""of a picture by which one may drive; above it the robot holds"""
_MOST_MARKS = 512
"""that may be under way: a minute of them"""


class PictureAge:
    """Follows one page: each mark tells up to when the picture before it was true."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        """Take the page's picture to be of this moment: an empty one."""
        self._clock = clock
        self._true_s = clock()
        self._marks: deque[tuple[int, float]] = deque(maxlen=_MOST_MARKS)
        self._number = 0

    @property
    def age_s(self) -> float:
        """Seconds since what the page shows was the present."""
        return self._clock() - self._true_s

    def mark(self, true_s: float) -> int:
        """Return the number of a new mark, behind a picture that was the present at `true_s`."""
        self._number += 1
        self._marks.append((self._number, true_s))
        return self._number

    def saw(self, number: int) -> None:
        """The page has got as far as that mark; one that was never sent tells nothing."""
        if number > self._number:
            return
        while self._marks and self._marks[0][0] <= number:
            self._true_s = self._marks.popleft()[1]
