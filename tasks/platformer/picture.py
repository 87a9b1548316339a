"""Pictures of the platformer from the side: a player among the tiles, and a whole stage."""

import mujoco
import numpy as np
from dm_control.mujoco import engine
from numpy.typing import NDArray

from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.platformer.stage import LENGTH_TILES

VIEW_HEIGHT_M = 14.0
"""of the overview camera in the world's file"""
MARGIN_M = 4.0
"""before the start and behind the flag"""


def film_frame(environment: ComposerEnvironment) -> NDArray[np.uint8]:
    """(360, 720, 3) RGB for films: 28 tiles, enough to see the gap before the player jumps."""
    return frame(environment, 720, 360)


def frame(
    environment: ComposerEnvironment, width_px: int = 640, height_px: int = 400
) -> NDArray[np.uint8]:
    """(height_px, width_px, 3) RGB of what is around the player, a third from the left (Fig. 2)."""
    width_m = VIEW_HEIGHT_M * width_px / height_px
    x_m = float(environment.physics.data.qpos[0])
    return from_the_side(environment, x_m + width_m / 6, width_px, height_px)


def whole_stage(
    environment: ComposerEnvironment, width_px: int = 1600, strips: int = 4
) -> NDArray[np.uint8]:
    """(h, width_px, 3) RGB of the present stage, cut into strips one below the other."""
    width_m = (LENGTH_TILES + 2 * MARGIN_M) / strips
    height_px = round(width_px * VIEW_HEIGHT_M / width_m)
    pictures = [
        from_the_side(environment, (number + 0.5) * width_m - MARGIN_M, width_px, height_px)
        for number in range(strips)
    ]
    # A dark line between two strips.
    return np.concatenate([np.pad(each, ((0, 4), (0, 0), (0, 0))) for each in pictures])


def from_the_side(
    environment: ComposerEnvironment, middle_x_m: float, width_px: int, height_px: int
) -> NDArray[np.uint8]:
    """Return a camera from the side, which sees the whole height of a stage."""
    physics = environment.physics
    model, data = physics.model.ptr, physics.data.ptr
    model.cam_pos[model.camera("overview").id, 0] = middle_x_m
    mujoco.mj_camlight(model, data)
    camera = engine.Camera(physics, height=height_px, width=width_px, camera_id="overview")
    return camera.render().copy()
