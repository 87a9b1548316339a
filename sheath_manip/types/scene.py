"""How a scene looks and stands, for viewers that know no simulator."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class SceneGeom:
    """One visible shape of the scene, fixed to a body, for viewers that know no simulator."""

    body: int
    """row in `ScenePose.bodies`"""
    shape: str
    """`box`, `sphere`, `capsule`, `cylinder`, `ellipsoid`, `mesh` or `picture` (textured plane)"""
    size: NDArray[np.float64]
    """(3,) metres: half extents of a box, ellipsoid or picture; (radius, half length, 0) of a
    capsule or cylinder along its z axis; (radius, 0, 0) of a sphere; scale of a mesh"""
    rgba: tuple[float, float, float, float]
    """each 0..1"""
    position_in_body: NDArray[np.float64]
    """(3,) metres"""
    wxyz_in_body: NDArray[np.float64]
    """(4,) unit quaternion"""
    vertices: NDArray[np.float32] | None = None
    """(v, 3) metres, of a mesh"""
    faces: NDArray[np.int32] | None = None
    """(t, 3), of a mesh"""
    picture: NDArray[np.uint8] | None = None
    """(h, w, 3) RGB, of a picture: row 0 lies at +y, column 0 at -x"""


@dataclass(frozen=True, eq=False)
class Surface:
    """A surface that deforms, as it is at one moment."""

    vertices_m: NDArray[np.float32]
    """(v, 3) in the world frame"""
    faces: NDArray[np.int32]
    """(t, 3); of a sheet that is cut they may differ from moment to moment"""
    rgb: tuple[float, float, float]
    """each 0..1"""


@dataclass(frozen=True, eq=False)
class Line:
    """A line that moves and grows, as it is at one moment."""

    points_m: NDArray[np.float32]
    """(k, 3) in the world frame; fewer than two are nothing"""
    rgb: tuple[float, float, float]
    """each 0..1"""


@dataclass(frozen=True, eq=False)
class CameraPose:
    """Where a camera in perspective stands at one moment, in the world frame."""

    position_m: NDArray[np.float64]
    """(3,)"""
    wxyz: NDArray[np.float64]
    """(4,) unit quaternion: x to the right in its picture, y down, z into it"""
    fov_rad: float
    """vertical"""


@dataclass(frozen=True, eq=False)
class ScenePose:
    """How a scene stands at one moment, in the world frame."""

    bodies: NDArray[np.float64]
    """(b, 7) position (m) and wxyz quaternion of every body"""
    tool_m: NDArray[np.float64] | None = None
    """(3,) the point whose path viewers draw: tool, car, player"""
    contacts_m: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 3)))
    """(c, 3) where bodies touch"""
    surfaces: tuple[Surface, ...] = ()
    """always as many"""
    lines: tuple[Line, ...] = ()
    """always as many: what is drawn on surfaces, such as a target and what is done of it"""
    cameras: Mapping[str, CameraPose] = field(default_factory=dict)
    """those in perspective that observations come from, by their names there"""
