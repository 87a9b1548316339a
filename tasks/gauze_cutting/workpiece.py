"""The sheet in a simulation: held by clips that may move, lying on a soft bed."""

from dataclasses import replace

import mujoco
import numpy as np
from numpy.typing import NDArray

from sheath_manip.tasks.gauze_cutting.bench import CLIPS, SHEET
from sheath_manip.tasks.gauze_cutting.cutting.locating import Lie, lie_of
from sheath_manip.tasks.gauze_cutting.cutting.pieces import free_pieces
from sheath_manip.tasks.gauze_cutting.cutting.sheet import Sheet
from sheath_manip.tasks.gauze_cutting.geometry import (
    CENTRE_M,
    CLIP_OF_VERTEX,
    CORNERS_M,
    MEMBRANE,
    MESH,
    SIDE_M,
    SPARE_TRIANGLES,
)
from sheath_manip.tasks.gauze_cutting.resting import clip_response
from sheath_manip.tasks.gauze_cutting.scene import Scene

SUPPORT_N_M = 0.3
"""of the bed below each vertex, upwards and downwards: bristles that the sheet sticks to. Without
it the part that is half cut out hangs, and the front of the cut turns upright after 200 degrees"""


class Workpiece:
    """One sheet, laid anew for each episode without compiling the model again."""

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        self._model, self._data = model, data
        clips = [mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, name) for name in CLIPS]
        self._mocap = model.body_mocapid[clips]
        flex = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_FLEX, SHEET)
        held = np.flatnonzero(CLIP_OF_VERTEX >= 0)
        first = model.flex_vertadr[flex]
        # They were compiled as fixed to the world; from now on each is carried by its clip.
        model.flex_vertbodyid[first + held] = np.array(clips)[CLIP_OF_VERTEX[held]]
        offsets = MESH.points_m[held] - CORNERS_M[CLIP_OF_VERTEX[held]]
        model.flex_vert[first + held] = np.column_stack([offsets, np.zeros(len(held))])
        self.sheet = Sheet(model, SHEET, MESH, SPARE_TRIANGLES, MEMBRANE)
        self._free = np.flatnonzero(~self.sheet.pinned)
        self._coordinates = self.sheet.coordinates[self._free][:, None] + np.arange(3)
        self._joints = self.sheet.joints[self._free] + 2
        # Spares have none: they lie in the middle.
        self._response = np.zeros((len(self._free), 2, 4, 2))
        mesh = self._free < len(MESH.points_m)
        self._response[mesh] = clip_response()[self._free[mesh]]
        self._homes_m = model.body_pos[self.sheet.bodies[self._free]] + CENTRE_M
        self._scene: Scene | None = None

    def lay(self, scene: Scene) -> None:
        """Put a whole sheet where and how `scene` has it, at rest."""
        self._scene = scene
        model, data, sheet = self._model, self._data, self.sheet
        sheet.membrane = replace(MEMBRANE, young_pa=scene.stiffness * MEMBRANE.young_pa)
        self.make_whole()
        rest = sheet.rest_m[self._free]
        displaced = np.einsum("nicj,cj->ni", self._response, scene.clips_m)
        flat = (rest + displaced) @ scene.rotation.T
        # The bed is deepest in the middle and level with the clips at the edges.
        share = 2 * rest / SIDE_M
        depth = scene.sag_m * np.prod(1 - share**2, axis=1)
        positions = scene.centre_m + np.column_stack([flat, -depth])
        data.qpos[self._coordinates] = positions - self._homes_m
        model.qpos_spring[self._coordinates[:, 2]] = data.qpos[self._coordinates[:, 2]]
        data.qvel[self.sheet.dofs[self._free][:, None] + np.arange(3)] = 0.0
        data.mocap_quat[self._mocap] = [
            np.cos(scene.yaw_rad / 2),
            0.0,
            0.0,
            np.sin(scene.yaw_rad / 2),
        ]
        self.move_clips(0.0)

    def make_whole(self) -> None:
        """Take back all cuts; where its vertices are is not changed."""
        self.sheet.restore()
        self._model.jnt_stiffness[self._joints] = SUPPORT_N_M

    def move_clips(self, time_s: float) -> None:
        """Move the clips to where they are at a time of the episode."""
        assert self._scene is not None, "no sheet has been laid yet"
        self._data.mocap_pos[self._mocap] = self._scene.clip_positions_m(time_s)

    def park_spares(self) -> None:
        """Hold the vertices of the pool, which hang on nothing, where they are."""
        spares = slice(self.sheet.spares.start, self.sheet.spares.stop)
        columns = self.sheet.coordinates[spares][:, None] + np.arange(3)
        self._data.qpos[columns] = 0.0
        self._data.qvel[self.sheet.dofs[spares][:, None] + np.arange(3)] = 0.0

    def lie(self) -> Lie:
        """Return how the sheet lies, as far as the bodies' kinematics are up to date."""
        return lie_of(self.sheet, self._data)

    def velocity_m_s(self, vertices: NDArray) -> NDArray[np.float64]:
        """(3,) mean of (k,) vertices; those in clips count as still."""
        free = vertices[~self.sheet.pinned[vertices]]
        columns = self.sheet.dofs[free][:, None] + np.arange(3)
        return self._data.qvel[columns].sum(axis=0) / len(vertices)

    def largest_strain(self, lie: Lie) -> float:
        """Return the largest strain of any edge, as the sheet lies."""
        sheet = self.sheet
        edges = sheet.active_edges
        ends = lie.positions_m[sheet.edges[edges]]
        return float(
            (np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) / sheet.lengths_m[edges]).max() - 1
        )

    def disc(self) -> NDArray[np.int64] | None:
        """The elements of the piece around the middle of the circle; None while it is not free."""
        middles = self.sheet.rest_m[self.sheet.active_elements].mean(axis=1)
        middle = int((middles**2).sum(axis=1).argmin())
        return next((piece for piece in free_pieces(self.sheet) if middle in piece), None)

    def stray_pieces(self) -> int:
        """Return how many pieces hang on nothing, the disc not counted."""
        return len(free_pieces(self.sheet)) - (self.disc() is not None)

    def let_go(self) -> None:
        """Take the bed away from below the disc, so that it falls."""
        disc = self.disc()
        if disc is not None:
            vertices = np.unique(self.sheet.elements[disc])
            self._model.jnt_stiffness[self.sheet.joints[vertices] + 2] = 0.0
