"""The way of a blade through the material since the front of its cut."""

import numpy as np
from numpy.typing import NDArray

LONGEST = 64
"""points that are remembered"""


class BladeTrail:
    """A polyline from the front of the cut to the blade, without what the blade went back over."""

    def __init__(self, spacing_m: float) -> None:
        """Points are `spacing_m` apart or more, but for the last one, where the blade is."""
        self.spacing_m = spacing_m
        self.points_m = np.zeros((0, 2))

    @property
    def length_m(self) -> float:
        """The length along the trail."""
        return float(np.linalg.norm(np.diff(self.points_m, axis=0), axis=1).sum())

    def start(self, point_m: NDArray) -> None:
        """Begin anew at (2,) `point_m`."""
        self.points_m = np.array(point_m, float)[None]

    def reach(self, point_m: NDArray) -> None:
        """The blade has come to (2,) `point_m`."""
        points = self.points_m
        if len(points) > 1 and np.linalg.norm(points[-1] - points[-2]) < self.spacing_m:
            points = points[:-1]
        # Who comes back to where it was has cut nothing by the detour.
        back = np.linalg.norm(points[:-1] - point_m, axis=1) < self.spacing_m / 2
        if back.any():
            points = points[: int(back.argmax()) + 1]
        self.points_m = np.concatenate([points, [point_m]])[-LONGEST:]

    def cut_off(self, along_m: float, point_m: NDArray) -> None:
        """Begin at the front's new place, (2,) `point_m`, with what lies beyond `along_m`."""
        ends = np.concatenate(
            [[0.0], np.linalg.norm(np.diff(self.points_m, axis=0), axis=1).cumsum()]
        )
        self.points_m = np.concatenate([[point_m], self.points_m[ends > along_m + 1e-12]])

    def nearest(self, points_m: NDArray) -> tuple[NDArray, NDArray, NDArray]:
        """Return for (n, 2) points (n,) distances, (n,) places on the trail, (n, 2) feet there."""
        start, way = self.points_m[:-1], np.diff(self.points_m, axis=0)
        lengths = np.linalg.norm(way, axis=1)
        offset = points_m[:, None] - start
        share = (offset * way).sum(-1) / np.maximum(lengths**2, 1e-30)
        feet = start + np.clip(share, 0.0, 1.0)[..., None] * way
        distances = np.linalg.norm(points_m[:, None] - feet, axis=-1)
        best = distances.argmin(axis=1)
        rows = np.arange(len(points_m))
        before = np.concatenate([[0.0], lengths.cumsum()[:-1]])
        along = before[best] + np.clip(share[rows, best], 0.0, 1.0) * lengths[best]
        return distances[rows, best], along, feet[rows, best]

    def memory(self) -> NDArray[np.float64]:
        """(2 LONGEST + 1,) all that it remembers."""
        memory = np.zeros(2 * LONGEST + 1)
        memory[0] = len(self.points_m)
        memory[1 : 1 + self.points_m.size] = self.points_m.ravel()
        return memory

    def recall(self, memory: NDArray) -> None:
        """Take over a `memory()`."""
        self.points_m = memory[1 : 1 + 2 * int(memory[0])].reshape(-1, 2).copy()
