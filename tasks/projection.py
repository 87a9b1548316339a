"""Where a camera shows what lies in a plane."""

from typing import Any

import numpy as np
from numpy.typing import NDArray


def px_of_horizontal_plane(camera: Any, side_px: int, height_m: float) -> NDArray[np.float64]:
    """Return (3, 3) from (x, y, 1) at that height, world frame, to (column, row, 1) up to scale.

    `camera` is an MJCF element of the world with `pos`, `xyaxes` and `fovy`; its image is square.
    MuJoCo's cameras look along their -z, with x to the right and y upwards.
    """
    right, upwards = np.reshape(camera.xyaxes, (2, 3)).astype(np.float64)
    right /= np.linalg.norm(right)
    upwards -= (upwards @ right) * right
    upwards /= np.linalg.norm(upwards)
    to_camera = np.stack([right, upwards, np.cross(right, upwards)])
    focal_px = side_px / 2 / np.tan(np.deg2rad(camera.fovy) / 2)
    middle = (side_px - 1) / 2
    projection = np.array([[-focal_px, 0, middle], [0, focal_px, middle], [0, 0, 1]])
    in_plane = np.column_stack([[1, 0, 0], [0, 1, 0], [0, 0, height_m] - np.asarray(camera.pos)])
    in_plane[:2, 2] = -np.asarray(camera.pos)[:2]
    return projection @ to_camera @ in_plane
