"""Lengths of the workpiece, and where it lies when nothing is out of place."""

import numpy as np

from sheath_manip.tasks.gauze_cutting.cutting.elasticity import Membrane
from sheath_manip.tasks.gauze_cutting.cutting.hex_mesh import hex_square

SIDE_M = 0.10
RADIUS_M = 0.025
"""of the printed circle, around the middle"""
MESH = hex_square(SIDE_M, 21)
MEMBRANE = Membrane(young_pa=2e5, poisson=0.2, thickness_m=5e-4)
"""a light sheet that is stiff for its weight, such as starched gauze"""
MASS_KG = 1.5e-3
DAMPING_S = 0.002
SPARE_TRIANGLES = 24
"""a circle takes 30 to 35 vertices; the rest is for detours"""
CENTRE_M = np.array([0.42, 0.0, 0.15])
"""nominal, world frame"""
CLIP_M = 0.0085
"""side of the corner that a clip holds"""
CORNERS_M = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * (SIDE_M - CLIP_M) / 2
"""(4, 2) middles of what the clips hold, in material coordinates"""
CLIP_OF_VERTEX = np.where(
    (np.abs(MESH.points_m) > SIDE_M / 2 - CLIP_M).all(axis=1),
    ((MESH.points_m[:, None] - CORNERS_M) ** 2).sum(-1).argmin(axis=1),
    -1,
)
"""(n,) number of the clip, or -1"""
