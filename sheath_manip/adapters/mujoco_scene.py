"""MuJoCo's visible geometry as plain values, for viewers that know no simulator."""

import mujoco
import numpy as np
from numpy.typing import NDArray

from sheath_manip.types import SceneGeom

_SHAPES = {
    mujoco.mjtGeom.mjGEOM_BOX: "box",
    mujoco.mjtGeom.mjGEOM_SPHERE: "sphere",
    mujoco.mjtGeom.mjGEOM_CAPSULE: "capsule",
    mujoco.mjtGeom.mjGEOM_CYLINDER: "cylinder",
    mujoco.mjtGeom.mjGEOM_ELLIPSOID: "ellipsoid",
    mujoco.mjtGeom.mjGEOM_MESH: "mesh",
    mujoco.mjtGeom.mjGEOM_PLANE: "picture",
}
_VISIBLE_GROUPS = (0, 1, 2)
_DEFAULT_RGBA = np.array([0.5, 0.5, 0.5, 1.0], np.float32)
"""MuJoCo's own: a geom that has another one is drawn in it whatever its material's is"""


def scene_geoms(model: mujoco.MjModel) -> list[SceneGeom]:
    """Return all opaque geoms of the groups that MuJoCo draws by default."""
    geoms = []
    for index in range(model.ngeom):
        shape = _SHAPES.get(mujoco.mjtGeom(model.geom_type[index]))
        rgba = _rgba(model, index)
        if shape is None or rgba[3] == 0 or model.geom_group[index] not in _VISIBLE_GROUPS:
            continue
        vertices, faces = _mesh(model, index) if shape == "mesh" else (None, None)
        geoms.append(
            SceneGeom(
                body=int(model.geom_bodyid[index]),
                shape=shape,
                size=np.ones(3) if shape == "mesh" else _size(model, index),
                rgba=(rgba[0], rgba[1], rgba[2], rgba[3]),
                position_in_body=model.geom_pos[index].copy(),
                wxyz_in_body=model.geom_quat[index].copy(),
                vertices=vertices,
                faces=faces,
                picture=_picture(model, index) if shape == "picture" else None,
            )
        )
    return geoms


def _size(model: mujoco.MjModel, geom: int) -> NDArray[np.float64]:
    size = model.geom_size[geom].copy()
    if model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_PLANE:
        # 0 is a plane without an end; MuJoCo draws it as far as it sees.
        size[:2] = np.where(size[:2] > 0, size[:2], 2 * model.stat.extent)
    return size


def _rgba(model: mujoco.MjModel, geom: int) -> list[float]:
    material, own = model.geom_matid[geom], model.geom_rgba[geom]
    has_own = material < 0 or not np.array_equal(own, _DEFAULT_RGBA)
    return [float(value) for value in (own if has_own else model.mat_rgba[material])]


def _mesh(model: mujoco.MjModel, geom: int) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
    mesh = model.geom_dataid[geom]
    vertex, face = model.mesh_vertadr[mesh], model.mesh_faceadr[mesh]
    return (
        model.mesh_vert[vertex : vertex + model.mesh_vertnum[mesh]].copy(),
        model.mesh_face[face : face + model.mesh_facenum[mesh]].copy(),
    )


def _picture(model: mujoco.MjModel, geom: int) -> NDArray[np.uint8]:
    """The texture of a plane, or one pixel of its colour where it has none."""
    material = model.geom_matid[geom]
    role = mujoco.mjtTextureRole.mjTEXROLE_RGB
    texture = -1 if material < 0 else int(model.mat_texid[material, role])
    if texture < 0:
        return np.rint(255 * np.array([[_rgba(model, geom)[:3]]])).astype(np.uint8)
    height, width = int(model.tex_height[texture]), int(model.tex_width[texture])
    channels, start = int(model.tex_nchannel[texture]), int(model.tex_adr[texture])
    flat = model.tex_data[start : start + height * width * channels]
    return flat.reshape(height, width, channels)[..., :3].copy()
