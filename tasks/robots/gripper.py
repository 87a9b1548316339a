"""How far a gripper is closed, from where its joints stand."""

import itertools
from bisect import bisect_right
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Protocol

from sheath_manip.exceptions import ParameterError


class Coupling(Protocol):
    """The way from the coordinate of a gripper's joints to how far it is closed, and back."""

    def closed_m(self, coordinate: float) -> float:
        """Return how far the gripper is closed, m; the coordinate is the signed sum of joints."""
        ...

    def coordinate(self, closed_m: float) -> float:
        """Return the coordinate at which the gripper is closed that far."""
        ...


@dataclass(frozen=True)
class Sliding:
    """The coupling of fingers that slide, 0 where they are open: the sum is how far it is."""

    def closed_m(self, coordinate: float) -> float:
        """Return the coordinate, in m already."""
        return coordinate

    def coordinate(self, closed_m: float) -> float:
        """Return the coordinate, in m already."""
        return closed_m


SLIDING = Sliding()


@dataclass(frozen=True)
class Measured:
    """A coupling by measured points, straight between them and beyond: linkages and hinges."""

    points: tuple[tuple[float, float], ...]
    """coordinate and how far closed (m), both of them rising or one falling all the way"""

    def __post_init__(self) -> None:
        coordinates, closed = zip(*self.points, strict=True) if self.points else ((), ())
        if len(self.points) < 2 or not (_monotone(coordinates) and _monotone(closed)):
            raise ParameterError(
                f"a gripper closed by {list(self.points)}; wanted two points or more of coordinate "
                "and m closed, each going one way only"
            )

    def closed_m(self, coordinate: float) -> float:
        """Return how far the gripper is closed, m."""
        return _along(self.points, coordinate)

    def coordinate(self, closed_m: float) -> float:
        """Return the coordinate at which the gripper is closed that far."""
        return _along([(closed, coordinate) for coordinate, closed in self.points], closed_m)


def _along(points: Iterable[tuple[float, float]], x: float) -> float:
    """The value at `x` of straight lines through `points`."""
    rising = sorted(points)
    place = bisect_right([each for each, _ in rising], x)
    (left, low), (right, high) = rising[min(max(place, 1), len(rising) - 1) - 1 :][:2]
    return low + (high - low) * (x - left) / (right - left)


def _monotone(values: Sequence[float]) -> bool:
    steps = [after - before for before, after in itertools.pairwise(values)]
    return all(step > 0 for step in steps) or all(step < 0 for step in steps)
