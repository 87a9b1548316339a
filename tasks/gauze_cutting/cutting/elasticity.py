"""What MuJoCo's compiler makes of a flat flex's geometry, for elements and edges that have changed.

Stretch: a St. Venant-Kirchhoff membrane written in the squared lengths of its edges (Weischedel,
A discrete geometric view on shear-deformable shell models, 2012, section 4.1). With the edges e_i
of a triangle of area A and thickness t, and symmetric T_i such that e_j' T_i e_j = delta_ij, the
strain is E = 1/2 sum_i (l_i^2 - L_i^2) T_i and

    K_ij = A t / 4 (mu T_i : T_j + lambda tr T_i tr T_j),
    mu = E / (2 (1 + nu)),  lambda = E nu / ((1 + nu) (1 - 2 nu)).

Bending: the quadratic curvature energy of Wardetzky et al., Discrete Quadratic Curvature Energies
(2007). With the edge from x0 to x1 between triangles with the tips x2 and x3 and the cotangents of
the four angles at its ends,

    B = mu t^3 / 12 * 3/2 / (A_1 + A_2) * c c'.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError

_UPPER = np.triu_indices(3)


@dataclass(frozen=True)
class Membrane:
    """An isotropic material."""

    young_pa: float
    poisson: float
    thickness_m: float

    def __post_init__(self) -> None:
        if not (self.young_pa > 0 and 0 <= self.poisson < 0.5 and self.thickness_m > 0):
            raise ParameterError(f"{self}; wanted young > 0, 0 <= poisson < 0.5 and thickness > 0")

    @property
    def shear_pa(self) -> float:
        """mu."""
        return self.young_pa / (2 * (1 + self.poisson))

    @property
    def lame_pa(self) -> float:
        """lambda."""
        return self.young_pa * self.poisson / ((1 + self.poisson) * (1 - 2 * self.poisson))


def stretch_stiffness(corners_m: NDArray, membrane: Membrane) -> NDArray[np.float64]:
    """(n, 6) upper triangles of K for triangles with (n, 3, 2) corners; edge i faces corner i."""
    edges = np.roll(corners_m, 1, axis=1) - np.roll(corners_m, -1, axis=1)
    areas = np.abs(_cross(edges[:, 0], edges[:, 1])) / 2
    # Rows of G map the entries (xx, yy, xy) of a symmetric tensor to its values along the edges.
    x, y = edges[..., 0], edges[..., 1]
    duals = np.linalg.inv(np.stack([x * x, y * y, 2 * x * y], axis=-1)).transpose(0, 2, 1)
    traces = duals[..., 0] + duals[..., 1]
    products = np.einsum("nia,nja,a->nij", duals, duals, [1.0, 1.0, 2.0])
    both = membrane.shear_pa * products + membrane.lame_pa * np.einsum("ni,nj->nij", traces, traces)
    stiffness = both * (areas * membrane.thickness_m / 4)[:, None, None]
    return stiffness[:, _UPPER[0], _UPPER[1]]


def bending_stiffness(corners_m: NDArray, membrane: Membrane) -> NDArray[np.float64]:
    """(n, 16) matrices B, row by row, for edges with (n, 4, 2) ends and tips."""
    x0, x1, x2, x3 = corners_m.transpose(1, 0, 2)
    from_start_2, from_start_3 = _cotangent(x0, x1, x2), _cotangent(x0, x1, x3)
    from_end_2, from_end_3 = _cotangent(x1, x2, x0), _cotangent(x1, x3, x0)
    weights = np.stack(
        [
            from_end_2 + from_end_3,
            from_start_2 + from_start_3,
            -(from_start_2 + from_end_2),
            -(from_start_3 + from_end_3),
        ],
        axis=-1,
    )
    area = (np.abs(_cross(x1 - x0, x2 - x0)) + np.abs(_cross(x1 - x0, x3 - x0))) / 2
    scale = 1.5 * membrane.shear_pa * membrane.thickness_m**3 / 12 / area
    return (scale[:, None, None] * np.einsum("ni,nj->nij", weights, weights)).reshape(-1, 16)


def _cotangent(corner: NDArray, one: NDArray, other: NDArray) -> NDArray[np.float64]:
    """(n,) of the angles at (n, 2) corners."""
    first, second = one - corner, other - corner
    return (first * second).sum(-1) / np.abs(_cross(first, second))


def _cross(first: NDArray, second: NDArray) -> NDArray[np.float64]:
    return first[..., 0] * second[..., 1] - first[..., 1] * second[..., 0]
