"""From places in the world to material coordinates and back, by the deformed elements."""

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from tasks.gauze_cutting.cutting.sheet import Sheet


@dataclass(frozen=True, eq=False)
class Place:
    """A point of the sheet."""

    element: int
    weights: NDArray[np.float64]
    """(3,) of the element's corners; negative where the point is beside it"""
    material_m: NDArray[np.float64]
    """(2,)"""
    world_m: NDArray[np.float64]
    """(3,)"""

    @property
    def inside(self) -> bool:
        """Whether the element holds it, and it was not extrapolated."""
        return bool(self.weights.min() >= -1e-9)


def vertex_positions(sheet: Sheet, data: mujoco.MjData) -> NDArray[np.float64]:
    """(n, 3) in the world frame, as the bodies are."""
    turned = data.xmat[sheet.bodies].reshape(-1, 3, 3)
    return data.xpos[sheet.bodies] + np.einsum("nij,nj->ni", turned, sheet.offsets_m)


def locate(
    sheet: Sheet,
    positions_m: NDArray,
    point_m: NDArray,
    near_m: NDArray,
    radius_m: float,
) -> Place:
    """The point of the sheet below or above (2,) `point_m`, seen along z.

    Only elements within `radius_m` of the material point `near_m` are looked at, because flaps may
    lie over one another. In a gap between them it is extrapolated from the nearest one.
    """
    active = sheet.active_elements
    middles = sheet.rest_m[active].mean(axis=1)
    away = np.linalg.norm(middles - near_m, axis=1)
    chosen = np.flatnonzero(away < radius_m)
    if not len(chosen):
        chosen = away.argmin(keepdims=True)
    corners = positions_m[active[chosen]]
    weights = barycentric(corners[..., :2], point_m)
    # Of several that hold it the one next to where it was looked for.
    outside = np.minimum(weights.min(axis=1), 0.0)
    best = int(np.lexsort((away[chosen], -outside))[0])
    element = int(chosen[best])
    return Place(
        element,
        weights[best],
        weights[best] @ sheet.rest_m[active[element]],
        weights[best] @ corners[best],
    )


def place_of(sheet: Sheet, positions_m: NDArray, material_m: NDArray) -> Place:
    """Where the material point (2,) `material_m` is in the world."""
    active = sheet.active_elements
    weights = barycentric(sheet.rest_m[active], material_m)
    element = int(weights.min(axis=1).argmax())
    return Place(
        element, weights[element], np.array(material_m), weights[element] @ positions_m[active[element]]
    )


def barycentric(corners_m: NDArray, point_m: NDArray) -> NDArray[np.float64]:
    """(n, 3) weights of (n, 3, 2) corners that sum up to (2,) `point_m`."""
    a, b, c = corners_m.transpose(1, 0, 2)
    first, second, third = b - a, c - a, point_m - a
    doubled = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
    # An element seen from its edge has no inside.
    doubled = np.where(np.abs(doubled) < 1e-15, np.inf, doubled)
    along = (third[:, 0] * second[:, 1] - third[:, 1] * second[:, 0]) / doubled
    across = (first[:, 0] * third[:, 1] - first[:, 1] * third[:, 0]) / doubled
    return np.stack([1 - along - across, along, across], axis=1)
