"""Conversion of places in the world to material coordinates and back, by the deformed elements."""

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from sheath_manip.tasks.gauze_cutting.cutting.sheet import Sheet

_CANDIDATES = 6
"""elements next to a point by their middles, one of which holds it in any mesh that is no sliver"""


@dataclass(frozen=True, eq=False)
class Place:
    """A point of the sheet."""

    corners: NDArray[np.int32]
    """(3,) vertices of the element"""
    weights: NDArray[np.float64]
    """(3,) of these; negative where the point is beside the element"""
    material_m: NDArray[np.float64]
    """(2,)"""
    world_m: NDArray[np.float64]
    """(3,)"""

    @property
    def inside(self) -> bool:
        """Whether the element holds the place, which was not extrapolated."""
        return bool(self.weights.min() >= -1e-9)


@dataclass(frozen=True, eq=False)
class Lie:
    """How a sheet lies in the world at one moment."""

    elements: NDArray[np.int32]
    """(t, 3) vertices"""
    material_m: NDArray[np.float64]
    """(n, 2) of the vertices"""
    positions_m: NDArray[np.float64]
    """(n, 3) of the vertices in the world frame"""

    def copy(self) -> "Lie":
        """Return one that stays as it is when the sheet moves on."""
        return Lie(self.elements.copy(), self.material_m.copy(), self.positions_m.copy())

    def below(self, point_m: NDArray, near_m: NDArray, radius_m: float) -> Place:
        """The point of the sheet below or above (2,) `point_m`, seen along z.

        Only elements within `radius_m` of the material point `near_m` are looked at, because flaps
        may lie over one another. In a gap it is extrapolated from the nearest one.
        """
        corners = self.material_m[self.elements]
        away = np.abs(corners[:, 0] - near_m).max(axis=1)
        chosen = np.flatnonzero(away < radius_m)
        if not len(chosen):
            chosen = away.argmin(keepdims=True)
        weights = barycentric(self.positions_m[self.elements[chosen], :2], point_m)
        # Of several that hold it the one next to where it was looked for.
        outside = np.maximum(-weights.min(axis=1), 0.0)
        best = int(np.lexsort((away[chosen], outside))[0])
        return self._place(int(chosen[best]), weights[best])

    def of(self, material_m: NDArray) -> Place:
        """Return where the material point (2,) `material_m` is.

        Beside the sheet it is extrapolated.
        """
        weights = barycentric(self.material_m[self.elements], material_m)
        element = int(weights.min(axis=1).argmax())
        return self._place(element, weights[element])

    def positions_of(self, material_m: NDArray) -> NDArray[np.float64]:
        """(k, 3) where (k, 2) material points are in the world: quicker for many, for pictures."""
        middles = self.material_m[self.elements].mean(axis=1)
        _, near = KDTree(middles).query(material_m, k=_CANDIDATES)
        corners = self.elements[near]
        points = np.repeat(material_m, _CANDIDATES, axis=0)
        flat = barycentric(self.material_m[corners].reshape(-1, 3, 2), points)
        weights = flat.reshape(*near.shape, 3)
        best = weights.min(axis=2).argmax(axis=1)
        rows = np.arange(len(material_m))
        return np.einsum("kc,kcx->kx", weights[rows, best], self.positions_m[corners[rows, best]])

    def _place(self, element: int, weights: NDArray) -> Place:
        corners = self.elements[element]
        return Place(
            corners,
            weights,
            weights @ self.material_m[corners],
            weights @ self.positions_m[corners],
        )


def lie_of(sheet: Sheet, data: mujoco.MjData) -> Lie:
    """Return how `sheet` lies now, as far as the bodies' kinematics are up to date."""
    return Lie(sheet.active_elements, sheet.rest_m, vertex_positions(sheet, data))


def vertex_positions(sheet: Sheet, data: mujoco.MjData) -> NDArray[np.float64]:
    """Return the (n, 3) vertices in the world frame."""
    positions = data.xpos[sheet.bodies]
    pinned = np.flatnonzero(sheet.pinned)
    turned = data.xmat[sheet.bodies[pinned]].reshape(-1, 3, 3)
    positions[pinned] += np.einsum("nij,nj->ni", turned, sheet.offsets_m[pinned])
    return positions


def barycentric(corners_m: NDArray, point_m: NDArray) -> NDArray[np.float64]:
    """(n, 3) weights of (n, 3, 2) corners that sum up to `point_m`, (2,) or (n, 2)."""
    a, b, c = corners_m.transpose(1, 0, 2)
    first, second, third = b - a, c - a, point_m - a
    doubled = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
    # An element seen from its edge has no inside.
    doubled = np.where(np.abs(doubled) < 1e-15, np.inf, doubled)
    along = (third[:, 0] * second[:, 1] - third[:, 1] * second[:, 0]) / doubled
    across = (first[:, 0] * third[:, 1] - first[:, 1] * third[:, 0]) / doubled
    return np.stack([1 - along - across, along, across], axis=1)
