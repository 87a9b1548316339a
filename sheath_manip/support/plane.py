"""The support of a set of positions in a plane, as score grids to draw level sets from."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from sklearn.svm import OneClassSVM

from sheath_manip.exceptions import ParameterError

MAX_POINTS = 800
NUS = (0.01, 0.05, 0.2, 0.5)

# Of the median squared distance. Measured on positions scattered over a ring-shaped road 9 m wide
# and 130 to 250 m long: at .01 the boundary of one lap's 100 positions breaks into islands that
# leave half of the centre line outside, and from .1 on it spreads over the road's inner edge.
BANDWIDTH_FACTOR = 0.03


@dataclass(frozen=True, eq=False)
class PlaneLevels:
    """One-class SVM scores over a grid of the plane; each boundary is where its scores are 0."""

    x_m: NDArray[np.float64]
    """(gx,) increasing"""
    y_m: NDArray[np.float64]
    """(gy,) increasing"""
    scores: Mapping[float, NDArray[np.float64]]
    """(gy, gx) by nu, positive inside"""


def plane_levels(
    positions: NDArray,
    nus: Sequence[float] = NUS,
    resolution: int = 160,
    seed: int = 0,
    bandwidth_factor: float = BANDWIDTH_FACTOR,
) -> PlaneLevels:
    """Fit a one-class SVM with k(x, y) = exp(-|x - y|²/c) to `positions` for each of `nus`.

    Args:
        positions: (n, 2) metres; of more than 800 a random 800 are used.
        nus: the share of positions allowed outside, each in 0..1.
        resolution: grid points along the longer side.
        seed: of the random choice.
        bandwidth_factor: c, as a multiple of the median squared distance.

    Raises:
        ParameterError: positions that are not (n, 2), not finite, or all in one place.
    """
    points = np.asarray(positions, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 2 or not np.isfinite(points).all():
        raise ParameterError(
            f"positions have shape {points.shape}; wanted (n, 2) finite metres in the plane"
        )
    if len(points) > MAX_POINTS:
        points = np.random.default_rng(seed).choice(points, MAX_POINTS, replace=False)
    squared = ((points[:, None] - points[None]) ** 2).sum(-1)
    apart = squared[squared > 0]
    if not apart.size:
        raise ParameterError(
            f"{len(points)} positions in one place have no support to draw; wanted two places"
        )
    bandwidth = bandwidth_factor * float(np.median(apart))

    # Two kernel widths beyond the outermost position every boundary has closed.
    margin = 2 * np.sqrt(bandwidth)
    low, high = points.min(0) - margin, points.max(0) + margin
    shape = np.maximum(np.rint(resolution * (high - low) / (high - low).max()), 2).astype(int)
    x_m, y_m = np.linspace(low[0], high[0], shape[0]), np.linspace(low[1], high[1], shape[1])

    # The kernel is a product of one factor for each axis, so a whole grid is one matrix product.
    kernel_x = np.exp(-((x_m[:, None] - points[:, 0]) ** 2) / bandwidth)
    kernel_y = np.exp(-((y_m[:, None] - points[:, 1]) ** 2) / bandwidth)
    gram = np.exp(-squared / bandwidth)
    scores = {}
    for nu in nus:
        machine = OneClassSVM(kernel="precomputed", nu=nu).fit(gram)
        chosen = machine.support_
        weighted_x = kernel_x[:, chosen] * machine.dual_coef_
        scores[nu] = kernel_y[:, chosen] @ weighted_x.T + machine.intercept_
    return PlaneLevels(x_m, y_m, scores)
