"""The arrays of a model that a cut edits, and the pool that it takes vertices and edges from."""

from collections.abc import Sequence

import mujoco
import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError, SheathError
from sheath_manip.tasks.gauze_cutting.cutting.elasticity import (
    Membrane,
    bending_stiffness,
    stretch_stiffness,
)
from sheath_manip.tasks.gauze_cutting.cutting.hex_mesh import Mesh

NONE = -1
"""in place of a flap's tip where an edge has an element on one side only"""


class SparesExhausted(SheathError):
    """The pool has not enough left for another cut; the sheet stays as it was."""


class Sheet:
    """One flex of a model, made of `mesh` and then of spare triangles that share no vertex.

    The model's own arrays are the state; `restore` brings back the uncut ones to the bit.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        flex: str,
        mesh: Mesh,
        spare_triangles: int,
        membrane: Membrane,
    ) -> None:
        """Take over `flex` of `model`, which `membrane` describes. Raises ParameterError."""
        self.model = model
        self.mesh = mesh
        self.membrane = self._compiled = membrane
        """of what is restored and cut from now on"""
        index = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_FLEX, flex)
        if index < 0:
            raise ParameterError(f"the model has no flex {flex!r}")
        first, count = int(model.flex_vertadr[index]), int(model.flex_vertnum[index])
        faces, lines = int(model.flex_elemnum[index]), int(model.flex_edgenum[index])
        wanted = len(mesh.points_m) + 3 * spare_triangles
        if count != wanted or model.flex_dim[index] != 2:
            raise ParameterError(
                f"flex {flex!r} has {count} vertices in {model.flex_dim[index]} dimensions; wanted "
                f"{wanted} in 2: those of the mesh, and 3 for each of {spare_triangles} spares"
            )
        vertices = slice(first, first + count)
        edge = int(model.flex_edgeadr[index])
        edges = slice(edge, edge + lines)
        corner = int(model.flex_elemdataadr[index])
        corners = slice(corner, corner + 3 * faces)
        side = int(model.flex_elemedgeadr[index])
        stiffness = int(model.flex_stiffnessadr[index])
        bending = int(model.flex_bendingadr[index])
        shell = int(model.flex_shelldataadr[index])

        self.elements = model.flex_elem[corners].reshape(-1, 3)
        """(t, 3) vertices"""
        self.element_edges = model.flex_elemedge[side : side + 3 * faces].reshape(-1, 3)
        """(t, 3) edges, each facing the corner of its column"""
        self.edges = model.flex_edge[edges]
        """(e, 2) vertices"""
        self.flaps = model.flex_edgeflap[edges]
        """(e, 2) tips of the elements on both sides"""
        self.lengths_m = model.flexedge_length0[edges]
        """(e,) unstretched"""
        self.stiffness = model.flex_stiffness[stiffness : stiffness + 21 * faces].reshape(-1, 21)
        self.bending = model.flex_bending[bending : bending + 17 * lines].reshape(-1, 17)
        self.bodies = model.flex_vertbodyid[vertices]
        self.offsets_m = model.flex_vert[vertices]
        """(n, 3) of vertices in their bodies"""
        shells = model.flex_shell[shell : shell + 2 * int(model.flex_shellnum[index])]
        textured = int(model.flex_texcoordadr[index])
        self.element_texture = self.texture = None
        if textured >= 0:
            self.element_texture = model.flex_elemtexcoord[corners].reshape(-1, 3)
            self.texture = model.flex_texcoord[textured : textured + count]
        self._columns, self._rows = model.flexedge_J_colind, model.flexedge_J_rowadr[edges]

        dofs = model.body_dofadr[self.bodies]
        self.pinned = model.body_dofnum[self.bodies] == 0
        """(n,) vertices that do not move by themselves, and are never doubled"""
        self.dofs = np.where(self.pinned, NONE, dofs)
        """(n,) the first of three"""
        self.joints = np.where(self.pinned, NONE, model.body_jntadr[self.bodies])
        self.coordinates = np.where(self.pinned, NONE, model.jnt_qposadr[self.joints])
        """(n,) the first of three in qpos"""
        self.rest_m = np.zeros((count, 2))
        """(n, 2) material coordinates; those of spares mean nothing"""
        self.rest_m[: len(mesh.points_m)] = mesh.points_m

        self._elements_in_mesh = len(mesh.triangles)
        used = self.element_edges[: self._elements_in_mesh]
        self._spare_edges = np.setdiff1d(np.arange(lines), used)
        # A triangle of the pool holds nothing and shows nothing; only its parts are used.
        self.elements[self._elements_in_mesh :] = self.elements[0, 0]
        self.stiffness[self._elements_in_mesh :] = 0.0
        shells[shells >= len(mesh.points_m)] = self.elements[0, 0]
        self._vertices_used = self._edges_used = 0
        self._tied = self._views()
        self._uncut = [array.copy() for array in self._tied]

    @property
    def spare_vertices(self) -> int:
        """The number of spare vertices that are left."""
        return len(self.rest_m) - len(self.mesh.points_m) - self._vertices_used

    @property
    def spare_edges(self) -> int:
        """The number of spare edges that are left."""
        return len(self._spare_edges) - self._edges_used

    @property
    def active_elements(self) -> NDArray[np.int32]:
        """(t, 3) vertices of the elements that are no spares, a view."""
        return self.elements[: self._elements_in_mesh]

    @property
    def active_edges(self) -> NDArray[np.int64]:
        """(e,) the edges in use."""
        spare = self._spare_edges
        return np.setdiff1d(np.arange(len(self.edges)), spare[self._edges_used :])

    @property
    def spares(self) -> slice:
        """The vertices that are not in use."""
        return slice(len(self.rest_m) - self.spare_vertices, len(self.rest_m))

    def restore(self) -> None:
        """Make it whole again, of its present `membrane`, which may differ in Young's modulus."""
        for array, uncut in zip(self._tied, self._uncut, strict=True):
            array[:] = uncut
        self._vertices_used = self._edges_used = 0
        if self.membrane != self._compiled:
            # Both are linear in it.
            factor = self.membrane.young_pa / self._compiled.young_pa
            self.stiffness *= factor
            self.bending *= factor

    def take_vertex(self) -> int:
        """Take a vertex of the pool; the caller has seen that there is one."""
        self._vertices_used += 1
        return self.spares.start - 1

    def take_edge(self) -> int:
        """Take an edge of the pool; the caller has seen that there is one."""
        self._edges_used += 1
        return int(self._spare_edges[self._edges_used - 1])

    def point_edge(self, edge: int, start: int, end: int) -> None:
        """Let `edge` run between two vertices."""
        self.edges[edge] = start, end
        dofs = np.sort([self.dofs[vertex] for vertex in (start, end) if not self.pinned[vertex]])
        columns = (dofs[:, None] + np.arange(3)).ravel()
        row = self._rows[edge]
        self._columns[row : row + len(columns)] = columns

    def elements_at(self, vertex: int) -> NDArray[np.int64]:
        """(k,) around a vertex."""
        return np.flatnonzero((self.active_elements == vertex).any(axis=1))

    def copies(self, vertex: int) -> NDArray[np.int64]:
        """(k,) all vertices of the same material point, itself included."""
        same = (self.rest_m[: self.spares.start] == self.rest_m[vertex]).all(axis=1)
        return np.flatnonzero(same)

    def on_rim(self, vertex: int) -> bool:
        """Return whether a vertex lies on the outer edge or on a cut."""
        around = np.unique(self.element_edges[self.elements_at(vertex)])
        own = around[(self.edges[around] == vertex).any(axis=1)]
        return bool((self.flaps[own, 1] == NONE).any())

    def recompute(self, elements: Sequence[int] | NDArray) -> None:
        """Lengths, stretch and bending of (k,) elements and their edges from `rest_m`."""
        elements = np.asarray(elements)
        self.stiffness[elements, :6] = stretch_stiffness(
            self.rest_m[self.elements[elements]], self.membrane
        )
        edges = np.unique(self.element_edges[elements])
        start, end = self.rest_m[self.edges[edges]].transpose(1, 0, 2)
        self.lengths_m[edges] = np.linalg.norm(end - start, axis=1)
        inner = edges[self.flaps[edges, 1] != NONE]
        corners = np.concatenate([self.edges[inner], self.flaps[inner]], axis=1)
        self.bending[inner, :16] = bending_stiffness(self.rest_m[corners], self.membrane)

    def _views(self) -> list[NDArray]:
        """All that a cut changes."""
        arrays = [
            self.elements,
            self.element_edges,
            self.edges,
            self.flaps,
            self.lengths_m,
            self.stiffness,
            self.bending,
            self.rest_m,
            self._columns,
        ]
        if self.texture is not None and self.element_texture is not None:
            arrays += [self.texture, self.element_texture]
        return arrays
