"""The scene of an environment as viser nodes: a frame for each body, its shapes below it."""

from collections.abc import Sequence
from dataclasses import fields
from itertools import product

import numpy as np
import viser
from numpy.typing import NDArray

from sheath_manip.dashboard.moment import Moment
from sheath_manip.dashboard.part import Desk
from sheath_manip.exceptions import ParameterError
from sheath_manip.types import SceneGeom

# viser draws row 0 of an image at -y and turns its face to -z; this is half a turn about x.
IMAGE_TURN_WXYZ = np.array([0.0, 1.0, 0.0, 0.0])
CAPSULE_SEGMENTS = 24
FIELD_OF_VIEW_RAD = np.deg2rad(45.0)
# Down at the scene from its -y side.
VIEW_DIRECTION = np.array([0.0, np.cos(np.deg2rad(67.0)), -np.sin(np.deg2rad(67.0))])
VIEW_MARGIN = 1.15


class SceneView:
    """Shows one scene and follows its bodies."""

    def __init__(self, desk: Desk) -> None:
        self._server = desk.viser
        self._root: viser.FrameHandle | None = None
        self._geoms: tuple[SceneGeom, ...] = ()
        self._frames: dict[int, viser.FrameHandle] = {}
        self._shown = np.zeros((0, 7))
        # Once only: afterwards the camera is where the person wants it.
        self._aimed = False

    def draw(self, moment: Moment) -> None:
        """Show the moment's scene as it stands."""
        self.build(moment.scene, moment.body_poses)
        self.move(moment.body_poses)

    def build(self, scene: Sequence[SceneGeom], body_poses: NDArray[np.float64]) -> None:
        """Show `scene` in place of the one before, or keep that where the two are equal.

        Raises:
            ParameterError: a shape of a kind that is not known, or without the arrays it needs.
        """
        if self._root is not None and _same_scene(scene, self._geoms):
            return
        if self._root is not None:
            self._root.remove()
        self._geoms = ()
        self._root = self._server.scene.add_frame("/world", show_axes=False)
        self._frames = {
            body: self._server.scene.add_frame(f"/world/{body}", show_axes=False)
            for body in sorted({geom.body for geom in scene})
        }
        for index, geom in enumerate(scene):
            _add_geom(self._server.scene, f"/world/{geom.body}/{index}", geom)
        self._geoms = tuple(scene)
        self._shown = np.full_like(body_poses, np.nan)
        if not self._aimed:
            self._aim_camera(body_poses)
            self._aimed = True

    @property
    def shown(self) -> tuple[SceneGeom, ...]:
        """What is shown: the same object until a scene comes that differs."""
        return self._geoms

    def move(self, body_poses: NDArray[np.float64]) -> None:
        """Put every body to its place, (b, 7) as from `Environment.body_poses`."""
        with np.errstate(invalid="ignore"):
            still = (np.abs(body_poses - self._shown) < 1e-6).all(axis=1)
        for body in np.flatnonzero(~still):
            if (frame := self._frames.get(int(body))) is not None:
                frame.position = body_poses[body, :3]
                frame.wxyz = body_poses[body, 3:]
        self._shown = body_poses

    def _aim_camera(self, body_poses: NDArray[np.float64]) -> None:
        if not self._geoms:
            return
        # A picture is the ground that things stand on, often much larger than what happens there.
        shown = [geom for geom in self._geoms if geom.shape != "picture"] or self._geoms
        centres = np.array([body_poses[geom.body, :3] + geom.position_in_body for geom in shown])
        reach = np.array([[_reach(geom)] for geom in shown])
        low, high = (centres - reach).min(0), (centres + reach).max(0)
        look_at = (low + high) / 2
        distance = VIEW_MARGIN * _distance_to_see(low - look_at, high - look_at)
        # Moves the cameras of pages that are open already, too: it is the first that they hear.
        camera = self._server.initial_camera
        camera.far = max(1000.0, 10 * distance)
        camera.fov = FIELD_OF_VIEW_RAD
        camera.position = look_at - distance * VIEW_DIRECTION
        camera.look_at = look_at


def _distance_to_see(low: NDArray[np.float64], high: NDArray[np.float64]) -> float:
    """How far back from the origin a camera along VIEW_DIRECTION sees the whole box."""
    corners = np.array(list(product(*zip(low, high, strict=True))))
    right = np.cross(VIEW_DIRECTION, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    across, up = corners @ right, corners @ np.cross(right, VIEW_DIRECTION)
    # In a window that is higher than wide the sides are cut off.
    wanted = np.maximum(np.abs(across), np.abs(up)) / np.tan(FIELD_OF_VIEW_RAD / 2)
    return float((wanted - corners @ VIEW_DIRECTION).max())


def _same_scene(left: Sequence[SceneGeom], right: Sequence[SceneGeom]) -> bool:
    return len(left) == len(right) and all(map(_same_geom, left, right))


def _same_geom(left: SceneGeom, right: SceneGeom) -> bool:
    pairs = ((getattr(left, each.name), getattr(right, each.name)) for each in fields(SceneGeom))
    return left is right or all(a is b or np.array_equal(a, b) for a, b in pairs)


def _reach(geom: SceneGeom) -> float:
    """The radius (metres) around the shape's origin that it surely stays within."""
    if geom.vertices is not None:
        return float(np.linalg.norm(geom.vertices * geom.size, axis=1).max(initial=0.0))
    return float(np.abs(geom.size).max())


def _add_geom(scene: viser.SceneApi, name: str, geom: SceneGeom) -> None:
    red, green, blue = (round(255 * channel) for channel in geom.rgba[:3])
    color = (red, green, blue)
    opacity = None if geom.rgba[3] >= 1 else geom.rgba[3]
    a, b, c = (float(extent) for extent in geom.size)
    wxyz = geom.wxyz_in_body
    match geom.shape:
        case "box":
            node = scene.add_box(name, color, (2 * a, 2 * b, 2 * c), opacity=opacity)
        case "sphere":
            node = scene.add_icosphere(name, a, color, opacity=opacity)
        case "ellipsoid":
            node = scene.add_icosphere(name, 1.0, color, scale=(a, b, c), opacity=opacity)
        case "cylinder":
            node = scene.add_cylinder(name, a, 2 * b, color, opacity=opacity)
        case "capsule":
            node = scene.add_mesh_simple(name, *capsule(a, b), color=color, opacity=opacity)
        case "mesh" if geom.vertices is not None and geom.faces is not None:
            node = scene.add_mesh_simple(
                name, geom.vertices, geom.faces, color=color, opacity=opacity, scale=(a, b, c)
            )
            node.side = "double"
        case "picture" if geom.picture is not None:
            node = scene.add_image(name, geom.picture, 2 * a, 2 * b, jpeg_quality=85)
            wxyz = _turned(wxyz, IMAGE_TURN_WXYZ)
        case "mesh" | "picture":
            raise ParameterError(
                f"a {geom.shape} came without arrays; "
                "wanted vertices and faces of a mesh, the pixels of a picture"
            )
        case _:
            raise ParameterError(
                f"a shape of kind {geom.shape!r}; "
                "known: box, sphere, capsule, cylinder, ellipsoid, mesh, picture"
            )
    node.position = geom.position_in_body
    node.wxyz = wxyz


def _turned(left: NDArray[np.float64], right: NDArray[np.float64]) -> NDArray[np.float64]:
    """The quaternion that turns by `right` first and by `left` then, wxyz."""
    w, v = left[0], left[1:]
    return np.concatenate(
        [
            [w * right[0] - v @ right[1:]],
            w * right[1:] + right[0] * v + np.cross(v, right[1:]),
        ]
    )


def capsule(radius: float, half_length: float) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
    """Vertices (v, 3) and faces (t, 3) of a capsule along z, ring after ring from below."""
    latitude = np.linspace(0, np.pi / 2, CAPSULE_SEGMENTS // 4 + 1)
    ring_radius = radius * np.concatenate([np.sin(latitude), np.cos(latitude)])
    ring_z = np.concatenate(
        [-half_length - radius * np.cos(latitude), half_length + radius * np.sin(latitude)]
    )
    angle = np.linspace(0, 2 * np.pi, CAPSULE_SEGMENTS, endpoint=False)
    vertices = np.stack(
        [
            np.outer(ring_radius, np.cos(angle)),
            np.outer(ring_radius, np.sin(angle)),
            np.repeat(ring_z[:, None], CAPSULE_SEGMENTS, 1),
        ],
        axis=-1,
    ).reshape(-1, 3)
    index = np.arange(len(vertices)).reshape(-1, CAPSULE_SEGMENTS)
    here, right = index[:-1], np.roll(index, -1, 1)[:-1]
    above, above_right = index[1:], np.roll(index, -1, 1)[1:]
    faces = np.concatenate(
        [np.stack([here, right, above_right], -1), np.stack([here, above_right, above], -1)]
    ).reshape(-1, 3)
    return vertices.astype(np.float32), faces.astype(np.int32)
