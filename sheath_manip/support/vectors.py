"""The vectors that a support is fitted to and scored on: what they must be, and how far apart."""

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError, UnknownNameError

# Points between which the median distance is taken: half a million pairs.
MEDIAN_POINTS = 1000
BANDWIDTH_UNITS = ("median", "dimensions")
"""the median squared distance between training points that differ, which follows the features'
units; or the number of dimensions, for binary features, where 0.01 then is one bit in a hundred"""
# Beyond this a vector is as far as any, and its square still fits float32.
LARGEST = 1e15

NO_SCALE = "all training vectors are equal, so they have no scale; wanted at least two that differ"


def checked_training(X: NDArray) -> NDArray[np.float64]:
    """(n, d) what a support can be fitted to; ParameterError where it cannot."""
    X = np.asarray(X, dtype=np.float64)
    if X.ndim != 2 or X.shape[1] == 0:
        raise ParameterError(f"cannot fit a support to shape {X.shape}; wanted (n, d) vectors")
    if len(X) < 2:
        raise ParameterError(f"cannot fit a support to {len(X)} vectors; wanted at least 2")
    broken = int((~np.isfinite(X).all(axis=1)).sum())
    if broken:
        raise ParameterError(f"{broken} of {len(X)} training vectors are not finite; wanted none")
    if not (X - X[0]).any():
        raise ParameterError(NO_SCALE)
    return X


def checked_agreement(agrees: NDArray | None, count: int) -> NDArray[np.bool_]:
    """(n,) where the policy is right: everywhere for None; ParameterError for another shape."""
    if agrees is None:
        return np.ones(count, dtype=bool)
    agrees = np.asarray(agrees)
    if agrees.shape != (count,) or agrees.dtype != np.bool_:
        raise ParameterError(
            f"agrees is {agrees.dtype} of shape {agrees.shape}; wanted bool of shape {(count,)}, "
            "one for each training vector"
        )
    return agrees


def checked_rows(X: NDArray, width: int) -> NDArray:
    """(n, width) rows to score, finite or not; ParameterError for another shape."""
    X = np.asarray(X)
    if X.ndim != 2 or X.shape[1] != width:
        raise ParameterError(f"cannot score vectors of shape {X.shape}; wanted (n, {width})")
    return X


def squared_distances(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """(n, n) between (n, d) points, exactly 0 on the diagonal."""
    squares = np.einsum("nd,nd->n", points, points)
    distances = points @ points.T
    # In place: of many points every copy costs more than the product.
    distances *= -2
    distances += squares[:, None] + squares[None]
    np.maximum(distances, 0, out=distances)
    np.fill_diagonal(distances, 0)
    return distances


def bandwidth(
    points: NDArray[np.float64], factor: float, unit: str, rng: np.random.Generator
) -> float:
    """c of exp(-|x - y|²/c) for (n, d) points: `factor` in one of `BANDWIDTH_UNITS`."""
    if unit not in BANDWIDTH_UNITS:
        raise UnknownNameError("bandwidth unit", unit, BANDWIDTH_UNITS)
    if unit == "dimensions":
        return factor * points.shape[1]
    return factor * median_squared_distance(points, rng)


def median_squared_distance(points: NDArray[np.float64], rng: np.random.Generator) -> float:
    """The median over pairs of (n, d) points that differ; of many points over a draw of them."""
    if len(points) > MEDIAN_POINTS:
        points = points[rng.choice(len(points), MEDIAN_POINTS, replace=False)]
    distances = squared_distances(points)[np.triu_indices(len(points), 1)]
    apart = distances[distances > 0]
    if len(apart) == 0:
        raise ParameterError(NO_SCALE)
    return float(np.median(apart))
