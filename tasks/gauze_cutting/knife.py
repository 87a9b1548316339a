"""The blade in the sheet: the way it takes, what it severs, and the friction on both."""

import mujoco
import numpy as np
from numpy.typing import NDArray

from sheath_manip.tasks.gauze_cutting.cutting.crack import Crack
from sheath_manip.tasks.gauze_cutting.cutting.journal import Cut, make, make_again, rows_of
from sheath_manip.tasks.gauze_cutting.cutting.locating import Lie, Place
from sheath_manip.tasks.gauze_cutting.cutting.sheet import SparesExhausted
from sheath_manip.tasks.gauze_cutting.workpiece import Workpiece

LOOK_M = 0.012
"""in material coordinates, around where the blade was: how far it is looked for"""
STICTION_M_S = 0.002
"""below this speed the friction falls to nothing"""
SMOOTHING = 0.5
"""of the friction from one control step to the next"""
MOST_CUTS = 128


class Knife:
    """Follows one blade through one sheet."""

    def __init__(self, workpiece: Workpiece, longest_path: int) -> None:
        """`longest_path` is how many points of the way are kept for the record."""
        self._workpiece = workpiece
        self.crack = Crack(workpiece.sheet)
        self._longest = longest_path
        self._path = np.zeros((0, 2))
        self._drag_n = np.zeros(3)
        self._tip_m = np.zeros(3)
        self.exhausted = False
        """the spares are used up: nothing is cut any more"""

    @property
    def path_m(self) -> NDArray[np.float64]:
        """The (k, 2) path of the blade in material coordinates, a point for each control step."""
        return self._path

    @property
    def drag_n(self) -> NDArray[np.float64]:
        """(3,) friction of the blade on the sheet, world frame."""
        return self._drag_n

    @property
    def tip_m(self) -> NDArray[np.float64]:
        """(3,) where the tip was when it moved last, world frame."""
        return self._tip_m

    def put_in(self, point_m: NDArray, tip_m: NDArray, data: mujoco.MjData) -> None:
        """Begin a new cut at (2,) material `point_m`, the blade's tip at (3,) `tip_m`."""
        self.crack.clear()
        self.exhausted = False
        self._path = np.array(point_m, float)[None]
        self._drag_n = np.zeros(3)
        self._tip_m = np.array(tip_m)
        self._cut(self.crack.puncture(point_m), data, self._workpiece.lie())

    def place(self, lie: Lie, tip_m: NDArray) -> Place:
        """Return where in the sheet the blade is."""
        return lie.below(tip_m[:2], self._path[-1], LOOK_M)

    def move(
        self, tip_m: NDArray, data: mujoco.MjData, friction_n: float, timestep_s: float
    ) -> Lie:
        """The tip has come to (3,) `tip_m` within a control step; how the sheet lies now."""
        lie = self._workpiece.lie()
        place = self.place(lie, tip_m)
        self._path = np.concatenate([self._path, place.material_m[None]])[-self._longest :]
        if tip_m[2] < place.world_m[2] and not self.exhausted:
            self.crack.trail.reach(place.material_m)
            try:
                while (cut := self.crack.next_cut()) is not None:
                    self._cut(cut, data, lie)
            except SparesExhausted:
                self.exhausted = True
        relative = (tip_m - self._tip_m) / timestep_s - self._workpiece.velocity_m_s(place.corners)
        relative[2] = 0.0
        speed = float(np.linalg.norm(relative))
        wanted = friction_n * relative / (speed + STICTION_M_S)
        self._drag_n = SMOOTHING * self._drag_n + (1 - SMOOTHING) * wanted
        self._tip_m = tip_m.copy()
        return lie

    def held_vertices(self) -> NDArray[np.int64]:
        """(k,) around the front, which share the blade's friction."""
        sheet = self._workpiece.sheet
        around = [sheet.elements_at(int(copy)) for copy in sheet.copies(self.crack.front)]
        vertices = np.unique(sheet.elements[np.concatenate(around)])
        return vertices[~sheet.pinned[vertices]].astype(np.int64)

    def memory(self) -> NDArray[np.float64]:
        """(m,) all that is remembered; of the same size always."""
        path = np.zeros((self._longest, 2))
        path[: len(self._path)] = self._path
        cuts = self.crack.cuts
        return np.concatenate(
            [
                [len(self._path), len(cuts), self.exhausted],
                self._drag_n,
                self._tip_m,
                path.ravel(),
                rows_of(cuts, MOST_CUTS).ravel(),
                self.crack.memory(),
            ]
        )

    def recall(self, memory: NDArray) -> None:
        """Take over a `memory()`, on a sheet that has just been restored."""
        points, cuts = int(memory[0]), int(memory[1])
        self.exhausted = bool(memory[2])
        self._drag_n, self._tip_m = memory[3:6].copy(), memory[6:9].copy()
        path_end = 9 + 2 * self._longest
        cuts_end = path_end + 5 * MOST_CUTS
        self._path = memory[9:path_end].reshape(-1, 2)[:points].copy()
        made = [Cut.of(row) for row in memory[path_end:cuts_end].reshape(-1, 5)[:cuts]]
        for cut in made:
            make_again(self._workpiece.sheet, cut)
        self.crack.recall(memory[cuts_end:], made)

    def _cut(self, cut: Cut, data: mujoco.MjData, lie: Lie) -> None:
        # More cannot be written down for a restored episode to make again.
        if len(self.crack.cuts) == MOST_CUTS:
            raise SparesExhausted(f"{MOST_CUTS} cuts have been made; wanted fewer")
        make(self._workpiece.sheet, cut, data, lie)
        self.crack.made(cut)
