"""The front of a cut, which follows the trail of a blade from vertex to vertex.

The trail is noted in material coordinates. Once the blade is a mesh size ahead of the front, the
vertex next to the front that lies nearest to the trail is moved onto it and the edge to it is cut.
A vertex of a cut that is already there is never moved; where the trail passes by one, the front
runs into it, and that is what closes a ring. The front is not given up for it: the next cut starts
from any copy of that vertex.
"""

import numpy as np
from numpy.typing import NDArray

from sheath_manip.tasks.gauze_cutting.cutting.journal import Cut
from sheath_manip.tasks.gauze_cutting.cutting.severing import edge_between
from sheath_manip.tasks.gauze_cutting.cutting.sheet import Sheet
from sheath_manip.tasks.gauze_cutting.cutting.snapping import may_snap
from sheath_manip.tasks.gauze_cutting.cutting.trail import BladeTrail

# All in mesh sizes.
_LEAD = 1.0
"""of the blade before the front follows"""
_LEAST_ADVANCE = 0.45
_LEAST_ADVANCE_INTO_CUT = 0.05
_ASIDE = 0.6
"""that a vertex may lie from the trail"""
_RIM_FIRST = 0.25
"""nearer a vertex of the rim counts: a bridge that is narrower than the mesh is cut through"""
_ASIDE_IN_CUT = 0.25
"""the same, if the way to it is cut already"""
_LOST = 2.5
"""of trail that no vertex could follow"""
_SPACING = 0.1


class Crack:
    """Chooses the cuts that a blade makes; making them is for `journal.make`."""

    def __init__(self, sheet: Sheet) -> None:
        self.sheet = sheet
        self.front = 0
        """vertex"""
        self.trail = BladeTrail(_SPACING * sheet.mesh.size_m)
        self._cuts: list[Cut] = []

    @property
    def cuts(self) -> tuple[Cut, ...]:
        """All cuts that have been made, in order."""
        return tuple(self._cuts)

    @property
    def front_m(self) -> NDArray[np.float64]:
        """(2,) material coordinates."""
        return self.sheet.rest_m[self.front]

    def clear(self) -> None:
        """Forget the cuts, of a sheet that has been restored."""
        self._cuts = []
        self.front = 0

    def puncture(self, point_m: NDArray) -> Cut:
        """How a cut begins at the material point (2,) `point_m`."""
        sheet = self.sheet
        points = sheet.rest_m[: sheet.spares.start]
        away = np.where(sheet.pinned[: len(points)], np.inf, ((points - point_m) ** 2).sum(1))
        vertex = int(away.argmin())
        snapped = None
        if may_snap(sheet, vertex, np.asarray(point_m)):
            snapped = float(point_m[0]), float(point_m[1])
        return Cut(vertex, vertex, snapped)

    def next_cut(self) -> Cut | None:
        """What is to be cut now; None until the blade has come farther."""
        size = self.sheet.mesh.size_m
        while self.trail.length_m >= _LEAD * size:
            beyond = self._cut_before()
            if beyond is None:
                cut = self._nearest_cut()
                lost = cut is None and self.trail.length_m > _LOST * size
                return self.puncture(self.trail.points_m[-1]) if lost else cut
            # Where it is cut already, the front goes along for nothing.
            self._move_front(beyond)
        return None

    def made(self, cut: Cut) -> None:
        """Note that `cut` has been made."""
        if cut.start == cut.end:
            self.front = cut.end
            self.trail.start(self.front_m)
        else:
            self._move_front(cut.end)
        self._cuts.append(cut)

    def memory(self) -> NDArray[np.float64]:
        """(m,) without the cuts."""
        return np.concatenate([[self.front], self.trail.memory()])

    def recall(self, memory: NDArray, cuts: list[Cut]) -> None:
        """Take over a `memory()`, of a sheet in which `cuts` have been made."""
        self.front = int(memory[0])
        self.trail.recall(memory[1:])
        self._cuts = list(cuts)

    def _neighbours(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Ends of the edges that could be cut from the front: (k,) there, (k,) beyond."""
        sheet, pairs = self.sheet, []
        for start in sheet.copies(self.front):
            around = np.unique(sheet.elements[sheet.elements_at(int(start))])
            pairs += [
                (start, end)
                for end in around
                if end != start
                and not sheet.pinned[end]
                and edge_between(sheet, int(start), int(end)) is not None
            ]
        starts, ends = np.array(pairs, np.int64).reshape(-1, 2).T
        return starts, ends

    def _nearest_cut(self) -> Cut | None:
        """To the neighbour next to the trail that the front may go to."""
        sheet, size = self.sheet, self.sheet.mesh.size_m
        starts, ends = self._neighbours()
        if not len(ends):
            return None
        aside, along, feet = self.trail.nearest(sheet.rest_m[ends])
        on_rim = np.array([sheet.on_rim(int(end)) for end in ends])
        for index in np.argsort(aside - _RIM_FIRST * size * on_rim, kind="stable"):
            end, point = int(ends[index]), feet[index]
            least = _LEAST_ADVANCE_INTO_CUT if on_rim[index] else _LEAST_ADVANCE
            if aside[index] > _ASIDE * size or along[index] < least * size:
                continue
            if on_rim[index]:
                return Cut(int(starts[index]), end)
            if may_snap(sheet, end, point):
                return Cut(int(starts[index]), end, (float(point[0]), float(point[1])))
        return None

    def _cut_before(self) -> int | None:
        """The vertex that the trail leads to along an edge which is cut already, if it does."""
        sheet, size = self.sheet, self.sheet.mesh.size_m
        ends = [
            there
            for cut in self._cuts
            for here, there in ((cut.start, cut.end), (cut.end, cut.start))
            if here != there and (sheet.rest_m[here] == self.front_m).all()
        ]
        if not ends:
            return None
        aside, along, _ = self.trail.nearest(sheet.rest_m[ends])
        best = int(aside.argmin())
        near = aside[best] < _ASIDE_IN_CUT * size and along[best] > _LEAST_ADVANCE * size
        return ends[best] if near else None

    def _move_front(self, vertex: int) -> None:
        point = self.sheet.rest_m[vertex]
        self.trail.cut_off(float(self.trail.nearest(point[None])[1][0]), point)
        self.front = vertex
