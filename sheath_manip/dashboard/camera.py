"""Where the page looks from before a person turns the view."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from sheath_manip.types import FirstView, SceneGeom, ScenePose

FIELD_OF_VIEW_RAD = np.deg2rad(45.0)
WHOLE = FirstView(0.0, azimuth_deg=90.0, elevation_deg=67.0)
"""the direction from which a scene without a view of its own is seen"""
MARGIN = 1.15


@dataclass(frozen=True, eq=False)
class Aim:
    """A camera's place."""

    position_m: NDArray[np.float64]
    """(3,)"""
    look_at_m: NDArray[np.float64]
    """(3,)"""


def aim(scene: Sequence[SceneGeom], pose: ScenePose, view: FirstView | None) -> Aim | None:
    """Aim at the tool as `view` says, else so that the whole scene is seen.

    The answer is None for an empty scene.
    """
    if view is not None and pose.tool_m is not None:
        distance_m = MARGIN * view.radius_m / np.tan(FIELD_OF_VIEW_RAD / 2)
        return Aim(pose.tool_m - distance_m * _direction(view), pose.tool_m)
    if not scene:
        return None
    # A picture is the ground that things stand on, often much larger than what happens there.
    shown = [geom for geom in scene if geom.shape != "picture"] or scene
    centres = np.array([pose.bodies[geom.body, :3] + geom.position_in_body for geom in shown])
    reach = np.array([[_reach_m(geom)] for geom in shown])
    low, high = (centres - reach).min(0), (centres + reach).max(0)
    look_at = (low + high) / 2
    direction = _direction(WHOLE)
    distance = MARGIN * _distance_to_see(low - look_at, high - look_at, direction)
    return Aim(look_at - distance * direction, look_at)


def _direction(view: FirstView) -> NDArray[np.float64]:
    azimuth, elevation = np.deg2rad(view.azimuth_deg), np.deg2rad(view.elevation_deg)
    level = np.cos(elevation)
    return np.array([level * np.cos(azimuth), level * np.sin(azimuth), -np.sin(elevation)])


def _distance_to_see(
    low: NDArray[np.float64], high: NDArray[np.float64], direction: NDArray[np.float64]
) -> float:
    """How far back from the origin a camera along `direction` sees the whole box."""
    corners = np.array(list(product(*zip(low, high, strict=True))))
    right = np.cross(direction, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    across, up = corners @ right, corners @ np.cross(right, direction)
    # In a window that is higher than wide the sides are cut off.
    wanted = np.maximum(np.abs(across), np.abs(up)) / np.tan(FIELD_OF_VIEW_RAD / 2)
    return float((wanted - corners @ direction).max())


def _reach_m(geom: SceneGeom) -> float:
    """The radius around the shape's origin that it surely stays within."""
    if geom.vertices is not None:
        return float(np.linalg.norm(geom.vertices * geom.size, axis=1).max(initial=0.0))
    return float(np.abs(geom.size).max())
