"""The way that a tool has come, without its detours."""

from collections import deque

import numpy as np
from numpy.typing import NDArray

from sheath_manip.controllers.twist_control import twist_between
from sheath_manip.exceptions import ParameterError


class Trail:
    """Waypoints of a tool at least so far apart; where it goes back they are taken up again."""

    def __init__(
        self, spacing_m: float = 0.01, spacing_rad: float = 0.1, longest: int = 500
    ) -> None:
        """Two poses are `spacing` apart if either distance is reached; `longest` waypoints."""
        if not (spacing_m > 0 and spacing_rad > 0 and longest > 1):
            raise ParameterError(
                f"waypoints {spacing_m} m or {spacing_rad} rad apart, at most {longest}; wanted "
                "both above 0 and 2 or more"
            )
        self.spacing_m = spacing_m
        self.spacing_rad = spacing_rad
        self._waypoints: deque[NDArray[np.float64]] = deque(maxlen=longest)

    def __len__(self) -> int:
        return len(self._waypoints)

    def clear(self) -> None:
        """Begin anew."""
        self._waypoints.clear()

    def pass_through(self, transform_tool_to_world: NDArray) -> None:
        """Note the (4, 4) pose where the tool is now."""
        points = self._waypoints
        # Nearer to the one before than the last one is: the tool has turned back.
        while len(points) > 1 and self.apart(points[-1], points[-2]) > self.apart(
            transform_tool_to_world, points[-2]
        ):
            points.pop()
        if not points or self.apart(transform_tool_to_world, points[-1]) >= 1.0:
            points.append(np.array(transform_tool_to_world))

    def before(self, transform_tool_to_world: NDArray) -> NDArray[np.float64] | None:
        """(4, 4) the waypoint on the way back from a pose; None before the first."""
        if not self._waypoints:
            return None
        last = self._waypoints[-1]
        if len(self._waypoints) == 1:
            return last
        # Half-way to the last one already: on to the one before it.
        near = self.apart(transform_tool_to_world, last) < 0.5
        return self._waypoints[-2] if near else last

    def apart(self, one: NDArray, other: NDArray) -> float:
        """How far two (4, 4) poses are from each other, in spacings."""
        moved = twist_between(one, other, 1.0)
        away_m, turned_rad = np.linalg.norm(moved.reshape(2, 3), axis=1)
        return float(max(away_m / self.spacing_m, turned_rad / self.spacing_rad))
