"""Pictures of the platformer: a player among the tiles, and a whole stage at a glance."""

from functools import partial
from math import floor
from pathlib import Path

import mujoco
import numpy as np
from dm_control.mujoco import engine
from numpy.typing import NDArray
from PIL import Image

from sheath_manip.dataset.naming import episode_name
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.experiments.figures.film import film
from sheath_manip.experiments.figures.intervention import (
    NothingToShowError,
    View,
    best_intervention,
)
from sheath_manip.experiments.figures.replayed import replayed
from sheath_manip.experiments.figures.style import WIDTH_PX, limited
from sheath_manip.learning.checkpoint import Checkpoint
from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.platformer.stage import LEAD_TILES, LENGTH_TILES
from sheath_manip.tasks.platformer.task import PlatformerTask
from sheath_manip.types import Episode, Purpose

VIEW_HEIGHT_M = 14.0
"""of the overview camera in the world's file"""
FRAME_HEIGHT_PX, STRIPS = 640, 2
"""of `scene`"""
COLOURS = 32
_NEAR_TILES = 5
"""in which a gap begins that one is before"""
_MARGIN_M = 4.0
"""before the start and behind the flag"""


def film_frame(environment: ComposerEnvironment) -> NDArray[np.uint8]:
    """(288, 384, 3) RGB for films: 19 tiles, enough to see the gap before the player jumps."""
    return frame(environment, 384, 288)


def scene(
    store: EpisodeStore, checkpoint: Checkpoint, environment: ComposerEnvironment, path: Path
) -> None:
    """The draft's Fig. 2: the middle of the demonstration of the checkpoint's training seed."""
    demonstrations = store.episodes(
        Purpose.DEMONSTRATION, run_seed=checkpoint.run_seed, need_images=False
    )
    shown = next(iter(demonstrations), None)
    if shown is None:
        raise NothingToShowError(
            f"{store.path} holds no demonstrations of seed {checkpoint.run_seed}; "
            "collect some first"
        )
    environment.reset(shown.info.seed)
    environment.restore(store.read(episode_name(shown.info)).steps[len(shown) // 2].state)
    write_scene(environment, path)


def before_a_gap(
    store: EpisodeStore, checkpoint: Checkpoint, environment: ComposerEnvironment, path: Path
) -> None:
    """A film of SHEATH taking over before a gap, on the stage of the checkpoint's training seed."""
    task = environment.task
    assert isinstance(task, PlatformerTask)

    def column(episode: Episode, index: int) -> int:
        environment.restore(episode.steps[min(index, len(episode) - 1)].state)
        return floor(task.moment.x) + LEAD_TILES

    def over_a_gap(episode: Episode, start: int, stop: int) -> bool:
        if episode.info.run_seed != checkpoint.run_seed:
            return False
        environment.reset(episode.info.seed)
        heights = task.stage.heights
        first, behind = column(episode, start), column(episode, stop)
        near = heights[first + 1 : min(first + 1 + _NEAR_TILES, behind)]
        return bool(heights[first] > 0 and heights[behind] > 0 and (near == 0).any())

    view = View(partial(replayed, environment, film_frame), environment.spec.action)
    film(best_intervention(store, view=view, wanted=over_a_gap), path)


def write_scene(environment: ComposerEnvironment, path: Path, width_px: int = WIDTH_PX) -> None:
    """What is around the player now, and below it the whole stage."""
    pictures = [
        frame(environment, width_px, FRAME_HEIGHT_PX * width_px // WIDTH_PX),
        np.zeros((4, width_px, 3), np.uint8),
        whole_stage(environment, width_px, STRIPS),
    ]
    path.parent.mkdir(parents=True, exist_ok=True)
    limited(Image.fromarray(np.concatenate(pictures)), COLOURS).save(path, optimize=True)


def frame(
    environment: ComposerEnvironment, width_px: int = 640, height_px: int = 400
) -> NDArray[np.uint8]:
    """(height_px, width_px, 3) RGB of what is around the player, a third from the left (Fig. 2)."""
    width_m = VIEW_HEIGHT_M * width_px / height_px
    x_m = float(environment.physics.data.qpos[0])
    return _picture(environment, x_m + width_m / 6, width_px, height_px)


def whole_stage(
    environment: ComposerEnvironment, width_px: int = 1600, strips: int = 4
) -> NDArray[np.uint8]:
    """(h, width_px, 3) RGB of the present stage, cut into strips one below the other."""
    width_m = (LENGTH_TILES + 2 * _MARGIN_M) / strips
    height_px = round(width_px * VIEW_HEIGHT_M / width_m)
    pictures = [
        _picture(environment, (number + 0.5) * width_m - _MARGIN_M, width_px, height_px)
        for number in range(strips)
    ]
    # A dark line between two strips.
    return np.concatenate([np.pad(each, ((0, 4), (0, 0), (0, 0))) for each in pictures])


def _picture(
    environment: ComposerEnvironment, middle_x_m: float, width_px: int, height_px: int
) -> NDArray[np.uint8]:
    """From the side, the whole height of a stage."""
    physics = environment.physics
    model, data = physics.model.ptr, physics.data.ptr
    model.cam_pos[model.camera("overview").id, 0] = middle_x_m
    mujoco.mj_camlight(model, data)
    camera = engine.Camera(physics, height=height_px, width=width_px, camera_id="overview")
    return camera.render().copy()
