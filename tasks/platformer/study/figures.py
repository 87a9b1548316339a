"""The platformer's own figures: the draft's Fig. 2, and SHEATH taking over before a gap."""

from functools import partial
from math import floor
from pathlib import Path

import numpy as np
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
from sheath_manip.experiments.figures.style import WIDTH_PX
from sheath_manip.files.outputs import written_aside
from sheath_manip.learning.checkpoint import Checkpoint
from sheath_manip.playback.gif import limited
from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.platformer.picture import film_frame, frame, whole_stage
from sheath_manip.tasks.platformer.stage import LEAD_TILES
from sheath_manip.tasks.platformer.task import PlatformerTask
from sheath_manip.types import Episode, Purpose

FRAME_HEIGHT_PX, STRIPS = 640, 2
"""of `scene`"""
COLOURS = 32
_NEAR_TILES = 5
"""in which a gap begins that one is before"""


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
    """Write a picture of what is around the player now, and below it the whole stage."""
    pictures = [
        frame(environment, width_px, FRAME_HEIGHT_PX * width_px // WIDTH_PX),
        np.zeros((4, width_px, 3), np.uint8),
        whole_stage(environment, width_px, STRIPS),
    ]
    with written_aside(path) as aside:
        limited(Image.fromarray(np.concatenate(pictures)), COLOURS).save(aside, optimize=True)
