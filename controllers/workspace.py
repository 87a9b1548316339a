"""Where an arm may be: its tool in a box, its links clear of each other and of what is fixed."""

from dataclasses import dataclass
from typing import Literal

import mujoco
import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError

_PLANE = mujoco.mjtGeom.mjGEOM_PLANE


@dataclass(frozen=True, eq=False)
class Breach:
    """A configuration that may not be."""

    limit: Literal["workspace", "collision"]
    what: str
    """what is too near to what, or outside"""
    inwards: NDArray[np.float64]
    """(j,) gradient of the clearance by joint, m/rad: the way out"""


class Workspace:
    """Tells whether an arm's configuration is one in which it may stand."""

    def __init__(
        self,
        model: mujoco.MjModel,
        tool_site: str,
        home_rad: NDArray,
        lower_m: NDArray,
        upper_m: NDArray,
        clearance_m: float = 0.005,
    ) -> None:
        """Guard the arm of `model`, which holds nothing that moves beside it.

        What is fixed to the world in `model`, such as a table, is kept clear of. Geoms of one link
        and of neighbouring links are not compared, and neither are those that are closer than
        `clearance_m` at `home_rad`: they could not be kept apart. The tool site stays in the box
        between `lower_m` and `upper_m`, both (3,), world frame. Raises ParameterError where it does
        not at home.
        """
        self._model = model
        self._data = mujoco.MjData(model)
        self._site = model.site(tool_site).id
        self.lower_m, self.upper_m = np.array(lower_m, float), np.array(upper_m, float)
        self.clearance_m = clearance_m
        self.tool_position_m(home_rad)
        compared = [pair for pair in _pairs(model) if self._distance_m(*pair) >= clearance_m]
        pairs = np.array(compared, int).reshape(-1, 2)
        # A plane first, so that what stands before it comes second.
        flat = model.geom_type[pairs[:, 1]] == _PLANE
        pairs[flat] = pairs[flat][:, ::-1]
        over_plane = model.geom_type[pairs[:, 0]] == _PLANE
        planes, over = pairs[over_plane].T
        self._pairs = np.concatenate([pairs[over_plane], pairs[~over_plane]])
        firsts, seconds = pairs[~over_plane].T
        self._ends = np.concatenate([over, firsts, seconds])
        radii = model.geom_rbound
        reach = radii[firsts] + radii[seconds] + clearance_m
        self._reach_squared = reach**2
        # A plane is fixed to the world, says MuJoCo's compiler.
        self._normals = self._data.geom_xmat[planes][:, 2::3]
        heights = np.vecdot(self._normals, self._data.geom_xpos[planes])
        self._plane_reach = heights + radii[over] + clearance_m
        breach = self.breach(home_rad)
        if breach is not None:
            raise ParameterError(f"at home {breach.what}; wanted a home within the limits")

    @property
    def compared(self) -> list[tuple[str, str]]:
        """The pairs of geoms that are kept apart, by name."""
        return [(self._name(first), self._name(second)) for first, second in self._pairs]

    def tool_position_m(self, positions_rad: NDArray) -> NDArray[np.float64]:
        """Return (3,) where the tool is, world frame, with the joints at (j,) `positions_rad`."""
        self._data.qpos[:] = positions_rad
        mujoco.mj_kinematics(self._model, self._data)
        return self._data.site_xpos[self._site].copy()

    def distance_m(self, positions_rad: NDArray) -> float:
        """The smallest distance between geoms that are compared."""
        self.tool_position_m(positions_rad)
        return min(self._distance_m(*pair) for pair in self._pairs)

    def breach(self, positions_rad: NDArray) -> Breach | None:
        """What is wrong with (j,) `positions_rad`; None where nothing is."""
        tool_m = self.tool_position_m(positions_rad)
        over = np.maximum(self.lower_m - tool_m, tool_m - self.upper_m)
        axis = int(over.argmax())
        if over[axis] > 0:
            sign = 1.0 if tool_m[axis] < self.lower_m[axis] else -1.0
            what = f"the tool is {over[axis]:.4f} m outside along {'xyz'[axis]}"
            return Breach("workspace", what, sign * self._jacobian(tool_m, self._tool_body)[axis])
        for first, second in self._near():
            distance_m = self._distance_m(first, second)
            if distance_m < self.clearance_m:
                names = f"{self._name(first)} and {self._name(second)}"
                what = f"{names} are {distance_m:.4f} m apart, wanted {self.clearance_m} m"
                return Breach("collision", what, self._parting(first, second))
        return None

    def _near(self) -> NDArray[np.int64]:
        """Pairs whose bounding spheres are not clear of each other."""
        places = self._data.geom_xpos[self._ends]
        planes, pairs = len(self._plane_reach), len(self._reach_squared)
        low = np.vecdot(self._normals, places[:planes]) < self._plane_reach
        apart = places[planes : planes + pairs] - places[planes + pairs :]
        near = np.vecdot(apart, apart) < self._reach_squared
        return self._pairs[np.concatenate([low, near])]

    def _parting(self, first: int, second: int) -> NDArray[np.float64]:
        """(j,) gradient of the distance between two geoms."""
        ends = np.zeros(6)
        distance_m = mujoco.mj_geomDistance(self._model, self._data, first, second, 1.0, ends)
        # Where they overlap the segment points the other way.
        normal = (ends[3:] - ends[:3]) / (distance_m or 1.0)
        bodies = self._model.geom_bodyid
        return normal @ (
            self._jacobian(ends[3:], bodies[second]) - self._jacobian(ends[:3], bodies[first])
        )

    def _jacobian(self, point_m: NDArray, body: int) -> NDArray[np.float64]:
        """(3, j) of a point of a body."""
        jacobian = np.zeros((3, self._model.nv))
        mujoco.mj_comPos(self._model, self._data)
        mujoco.mj_jac(self._model, self._data, jacobian, None, point_m, body)
        return jacobian

    @property
    def _tool_body(self) -> int:
        return int(self._model.site_bodyid[self._site])

    def _distance_m(self, first: int, second: int) -> float:
        return mujoco.mj_geomDistance(self._model, self._data, first, second, 10.0, None)

    def _name(self, geom: int) -> str:
        return self._model.geom(geom).name or f"geom {geom}"


def _pairs(model: mujoco.MjModel) -> list[tuple[int, int]]:
    """Geoms of different links that are no neighbours, as MuJoCo has it: the world is nobody's."""
    link = model.body_weldid[model.geom_bodyid]
    before = model.body_weldid[model.body_parentid[link]]
    before = np.where(before == 0, -1, before)
    return [
        (first, second)
        for first in range(model.ngeom)
        for second in range(first + 1, model.ngeom)
        if link[first] != link[second]
        and link[first] != before[second]
        and link[second] != before[first]
    ]
