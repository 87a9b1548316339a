"""Thins the meshes of arms that are only looked at: makers draw each screw."""

from functools import lru_cache
from typing import Any

import mujoco
import numpy as np
from dm_control import mjcf
from numpy.typing import NDArray

from sheath_manip.tasks.robots.elements import inherited

CELL_M = 0.005
"""points that are nearer than this become one: a pixel of a film, from where its camera stands"""
_CELLS = 30
"""along a mesh at least: a small part keeps its shape"""
_FEW = 500
"""faces, up to which a mesh is left as it is"""


def thin(root: Any, drawn: list[Any]) -> None:
    """Give the `drawn` geoms of `root` meshes of fewer faces; those of other geoms stay."""
    thinned = dict[str, Any]()
    for geom in drawn:
        mesh = geom.mesh
        if mesh is None or mesh.file is None:
            continue
        if mesh.name not in thinned:
            scale = tuple(float(each) for each in inherited(mesh, "scale", (1.0, 1.0, 1.0)))
            stl = _thinned(mesh.file.contents, mesh.file.extension, scale)
            thinned[mesh.name] = mesh if stl is None else _added(root, mesh, stl)
        geom.mesh = thinned[mesh.name]


def clustered(
    points_m: NDArray, faces: NDArray, cell_m: float
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """(n, 3) points and (m, 3) faces, with one point for all that lie in a cell of a grid.

    Faces that come to nothing, or come twice, are left out.
    """
    cells = np.floor(points_m / cell_m).astype(np.int64)
    _, owner = np.unique(cells, axis=0, return_inverse=True)
    owner = owner.ravel()
    counts = np.bincount(owner)
    means = [np.bincount(owner, points_m[:, axis]) / counts for axis in range(3)]
    joined = owner[faces]
    whole = (joined != np.roll(joined, 1, axis=1)).all(axis=1)
    joined = joined[whole]
    _, first = np.unique(np.sort(joined, axis=1), axis=0, return_index=True)
    return np.stack(means, axis=1), joined[np.sort(first)]


@lru_cache(maxsize=256)
def _thinned(content: bytes, extension: str, scale: tuple[float, ...]) -> bytes | None:
    """The mesh as STL, in m; None where it has few faces."""
    sizes = " ".join(str(each) for each in scale)
    name = f"mesh{extension}"
    # The shape of its inertia does not matter here, and open ones have none.
    xml = (
        f'<mujoco><asset><mesh name="mesh" file="{name}" scale="{sizes}" inertia="shell"/></asset>'
        '<worldbody><geom type="mesh" mesh="mesh"/></worldbody></mujoco>'
    )
    model = mujoco.MjModel.from_xml_string(xml, {name: content})
    if model.nmeshface <= _FEW:
        return None
    rotation = np.empty(9)
    mujoco.mju_quat2Mat(rotation, model.mesh_quat[0])
    # As the file has it, before the compiler moved it to its middle.
    points = model.mesh_vert @ rotation.reshape(3, 3).T + model.mesh_pos[0]
    cell_m = min(CELL_M, float(np.ptp(points, axis=0).max()) / _CELLS)
    return _stl(*clustered(points, model.mesh_face, cell_m))


def _added(root: Any, mesh: Any, stl: bytes) -> Any:
    file = mjcf.Asset(stl, ".stl")
    return root.asset.add("mesh", name=f"{mesh.name}_thin", file=file, scale=[1, 1, 1])


def _stl(points_m: NDArray, faces: NDArray) -> bytes:
    """A binary STL; its normals are left for the reader to work out."""
    triangle = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    triangles = np.zeros(len(faces), triangle)
    triangles["corners"] = points_m[faces]
    return bytes(80) + np.uint32(len(faces)).tobytes() + triangles.tobytes()
