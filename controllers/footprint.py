"""How much room a tool's footprint has between outlines, by the way that it is turned."""

import numpy as np
from numpy.typing import NDArray


def clearances(
    points_m: NDArray, yaws_rad: NDArray, half_along_m: float, half_across_m: float
) -> NDArray[np.float64]:
    """(k,) least distance of (p, 2) points to a rectangle around the origin, 0 where one is inside.

    The rectangle's long axis is turned by (k,) `yaws_rad` from x. Infinite without points.
    """
    cos, sin = np.cos(yaws_rad)[:, None], np.sin(yaws_rad)[:, None]
    x, y = points_m[None, :, 0], points_m[None, :, 1]
    beyond_along = np.maximum(np.abs(cos * x + sin * y) - half_along_m, 0.0)
    beyond_across = np.maximum(np.abs(cos * y - sin * x) - half_across_m, 0.0)
    return np.sqrt((beyond_along**2 + beyond_across**2).min(axis=1, initial=np.inf))
