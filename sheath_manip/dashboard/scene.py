"""The scene of an environment as viser nodes: a frame for each body, its shapes below it."""

from collections.abc import Sequence
from dataclasses import fields

import numpy as np
import viser
from numpy.typing import NDArray

from sheath_manip.dashboard.camera import FIELD_OF_VIEW_RAD, aim
from sheath_manip.dashboard.following import Following
from sheath_manip.dashboard.snapshot import Snapshot
from sheath_manip.dashboard.widget import WidgetContext
from sheath_manip.exceptions import ParameterError
from sheath_manip.types import SceneGeom, ScenePose

WORLD = "/world"
"""the frame below which all of a page's scene hangs"""
# viser draws row 0 of an image at -y and turns its face to -z; this is half a turn about x.
IMAGE_TURN_WXYZ = np.array([0.0, 1.0, 0.0, 0.0])
CAPSULE_SEGMENTS = 24
SLAB_M = 0.004
"""thickness of a plane of one colour, which is a body that light falls on and no picture"""
FARTHEST_M = 1000.0
"""that is seen, at least"""


class SceneView:
    """Shows one scene and follows its bodies; the view follows the tool where it is asked to.

    Everything hangs below one frame, `/world`. To follow the tool that frame is shifted the other
    way, so that the camera stays where the person has it.
    """

    def __init__(self, context: WidgetContext, following: Following | None = None) -> None:
        self._server = context.viser
        self._first_view = context.spec.first_view
        self._following = following
        self._root = self._server.scene.add_frame(WORLD, show_axes=False)
        self._scene: viser.FrameHandle | None = None
        self._geoms: tuple[SceneGeom, ...] = ()
        self._frames: dict[int, viser.FrameHandle] = {}
        self._shown = np.zeros((0, 7))
        self._home_m: NDArray[np.float64] | None = None

    def draw(self, snapshot: Snapshot) -> None:
        """Show the snapshot's scene as it stands."""
        self.build(snapshot.scene, snapshot.pose)
        self.move(snapshot.pose)

    def build(self, scene: Sequence[SceneGeom], pose: ScenePose) -> None:
        """Show `scene` in place of the one before, or keep that where the two are equal.

        Raises:
            ParameterError: a shape of a kind that is not known, or without the arrays it needs.
        """
        if self._scene is not None and same_scene(scene, self._geoms):
            return
        if self._scene is not None:
            self._scene.remove()
        self._geoms = ()
        name = f"{WORLD}/scene"
        self._scene = self._server.scene.add_frame(name, show_axes=False)
        self._frames = {
            body: self._server.scene.add_frame(f"{name}/{body}", show_axes=False)
            for body in sorted({geom.body for geom in scene})
        }
        for index, geom in enumerate(scene):
            add_geom(self._server.scene, f"{name}/{geom.body}/{index}", geom)
        self._geoms = tuple(scene)
        self._shown = np.full_like(pose.bodies, np.nan)
        # Once only: afterwards the camera is where the person wants it.
        if self._home_m is None:
            self._aim_camera(pose)

    def move(self, pose: ScenePose) -> None:
        """Put every body to its place."""
        with np.errstate(invalid="ignore"):
            still = np.abs(pose.bodies - self._shown) < 1e-6
        for body in np.flatnonzero(~still.all(axis=1)).tolist():
            if (frame := self._frames.get(body)) is None:
                continue
            if not still[body, :3].all():
                frame.position = pose.bodies[body, :3]
            if not still[body, 3:].all():
                frame.wxyz = pose.bodies[body, 3:]
        self._shown = pose.bodies
        if self._following is not None and self._following.on and pose.tool_m is not None:
            assert self._home_m is not None
            self._root.position = self._home_m - pose.tool_m
        elif np.any(self._root.position):
            self._root.position = np.zeros(3)

    def _aim_camera(self, pose: ScenePose) -> None:
        aimed = aim(self._geoms, pose, self._first_view)
        if aimed is None:
            return
        # Moves the cameras of pages that are open already, too: it is the first that they hear.
        camera = self._server.initial_camera
        camera.far = max(FARTHEST_M, 10 * float(np.linalg.norm(aimed.look_at_m - aimed.position_m)))
        camera.fov = FIELD_OF_VIEW_RAD
        camera.position = aimed.position_m
        camera.look_at = aimed.look_at_m
        self._home_m = aimed.look_at_m


def same_scene(left: Sequence[SceneGeom], right: Sequence[SceneGeom]) -> bool:
    """Return whether the two show the same shapes."""
    # Throughout an episode they are the same object, and dozens of shapes need no look a frame.
    return left is right or (len(left) == len(right) and all(map(_same_geom, left, right)))


def _same_geom(left: SceneGeom, right: SceneGeom) -> bool:
    pairs = ((getattr(left, each.name), getattr(right, each.name)) for each in fields(SceneGeom))
    return left is right or all(a is b or np.array_equal(a, b) for a, b in pairs)


def add_geom(scene: viser.SceneApi, name: str, geom: SceneGeom) -> None:
    """Add a shape below the frame of its body; raises ParameterError as `SceneView.build` does."""
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
        case "picture" if (slab := plain(geom)) is not None:
            # So thin a body would lie in its own shadow here and there.
            node = scene.add_box(name, slab, (2 * a, 2 * b, SLAB_M), cast_shadow=False)
            node.position = geom.position_in_body - SLAB_M / 2 * upwards(wxyz)
            node.wxyz = wxyz
            return
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


def plain(geom: SceneGeom) -> tuple[int, int, int] | None:
    """Return the one colour of a textured plane; None where it has several, or is no plane."""
    if geom.picture is None or geom.picture.shape[:2] != (1, 1):
        return None
    red, green, blue = (int(channel) for channel in geom.picture[0, 0])
    return red, green, blue


def upwards(wxyz: NDArray[np.float64]) -> NDArray[np.float64]:
    """(3,) the z axis that the quaternion turns to."""
    w, x, y, z = wxyz
    return np.array([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)])


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
