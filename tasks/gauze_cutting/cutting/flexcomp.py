"""Writes a sheet that can be cut into an MJCF model."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sheath_manip.tasks.gauze_cutting.cutting.elasticity import Membrane
from sheath_manip.tasks.gauze_cutting.cutting.hex_mesh import Mesh

_SPARE_M = 0.002
"""side of a triangle of the pool"""


def add_sheet(
    parent: Any,
    name: str,
    mesh: Mesh,
    membrane: Membrane,
    spare_triangles: int,
    pinned: NDArray,
    vertex_mass_kg: float,
    damping_s: float,
    radius_m: float = 4e-4,
    material: str | None = None,
) -> Any:
    """Add a flexcomp to an mjcf body: the mesh in its x-y plane, and the pool around its origin.

    (k,) `pinned` vertices are fixed to that body. A texture covers the square that bounds the mesh.
    """
    angles = np.arange(3) * 2 * np.pi / 3
    corner = _SPARE_M * np.column_stack([np.cos(angles), np.sin(angles)])
    points = np.concatenate([mesh.points_m, *[corner] * spare_triangles])
    spares = len(mesh.points_m) + np.arange(3 * spare_triangles).reshape(-1, 3)
    low, high = mesh.points_m.min(axis=0), mesh.points_m.max(axis=0)
    texture = (points - low) / (high - low)
    settings = {} if material is None else {"material": material, "texcoord": texture.ravel()}
    flex = parent.add(
        "flexcomp",
        name=name,
        type="direct",
        dim=2,
        point=np.column_stack([points, np.zeros(len(points))]).ravel(),
        element=np.concatenate([mesh.triangles, spares]).ravel(),
        mass=vertex_mass_kg * len(points),
        radius=radius_m,
        **settings,
    )
    flex.elasticity.young = membrane.young_pa
    flex.elasticity.poisson = membrane.poisson
    flex.elasticity.thickness = membrane.thickness_m
    flex.elasticity.elastic2d = "both"
    flex.elasticity.damping = damping_s
    flex.contact.contype = flex.contact.conaffinity = 0
    flex.contact.selfcollide = "none"
    if len(pinned):
        flex.add("pin", id=np.asarray(pinned))
    return flex
