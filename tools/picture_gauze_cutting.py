"""The README's film strip of gauze cutting, and a film of it.

    python -m tools.picture_gauze_cutting [--scene 1] [--path docs/gauze-cutting.png]
                                          [--film docs/gauze-cutting.gif]

shows the expert's episode in that tuning scene: the sheet before, half cut, and the disc falling;
below it what the policy sees. The film is at the robot's own pace, the fall at a third of it.
"""

import argparse
from collections.abc import Sequence
from pathlib import Path

import cv2
import mujoco
import numpy as np
from numpy.typing import NDArray
from PIL import Image

from sheath_manip.playback.gif import limited
from sheath_manip.seeding import scene_seed
from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.gauze_cutting.expert import GauzeExpert
from sheath_manip.tasks.gauze_cutting.scenario import CAMERA
from sheath_manip.tasks.gauze_cutting.task import GauzeTask
from sheath_manip.tasks.rendering import PyramidCamera
from sheath_manip.types import Observation, Purpose

RENDERED_PX = 600
SHOWN_PX = 420
GAP_PX = 6
FRAME_STEPS = 2
"""control steps from one picture to the next, 0.1 s"""
FALL_STEPS = 3
"""of the physics, 0.03 s, once the disc is free"""
FALL_FRAMES = 6
SHOWN_FALLING = (2, 5)
"""frames of the fall in the strip"""
FILM_PX = 240
FRAME_MS, PAUSE_MS = 100, 1200
COLOURS = 64


def columns(scene: int) -> list[NDArray[np.uint8]]:
    """Pictures of tuning scene number `scene`, the last `FALL_FRAMES` of the falling disc."""
    environment = ComposerEnvironment(GauzeTask())
    expert = GauzeExpert(environment)
    shown = PyramidCamera("side", RENDERED_PX, pyramid_levels=0)
    observation = environment.reset(scene_seed(Purpose.EVALUATION, "tuning", scene))
    found, ended, steps = [_column(shown(environment.physics), observation)], False, 0
    while not ended:
        transition = environment.step(expert.act(observation))
        observation, ended = transition.observation, transition.terminated or transition.truncated
        steps += 1
        if steps % FRAME_STEPS == 0:
            found.append(_column(shown(environment.physics), observation))
    for _ in range(FALL_FRAMES):
        model, data = environment.physics.model.ptr, environment.physics.data.ptr
        mujoco.mj_step(model, data, FALL_STEPS)
        mujoco.mj_forward(model, data)
        found.append(_column(shown(environment.physics), environment.observe()))
    environment.close()
    return found


def _column(picture: NDArray[np.uint8], observation: Observation) -> NDArray[np.uint8]:
    size = (SHOWN_PX, SHOWN_PX)
    above = cv2.resize(picture, size, interpolation=cv2.INTER_AREA)
    seen = cv2.resize(observation.images[CAMERA], size, interpolation=cv2.INTER_NEAREST)
    gap = np.full((GAP_PX, SHOWN_PX, 3), 255, np.uint8)
    return np.concatenate([above, gap, seen]).astype(np.uint8)


def strip(pictures: Sequence[NDArray[np.uint8]]) -> NDArray[np.uint8]:
    """Before, half cut, and the fall, side by side."""
    falling = len(pictures) - FALL_FRAMES
    chosen = [0, falling // 2, *(falling + frame for frame in SHOWN_FALLING)]
    gap = np.full((pictures[0].shape[0], GAP_PX, 3), 255, np.uint8)
    return np.concatenate([part for index in chosen for part in (gap, pictures[index])][1:], axis=1)


def write_film(pictures: Sequence[NDArray[np.uint8]], path: Path) -> None:
    """An animated GIF: from the side, and beside it what the policy sees."""
    small = [
        cv2.resize(
            np.concatenate([each[:SHOWN_PX], each[-SHOWN_PX:]], axis=1),
            (2 * FILM_PX, FILM_PX),
            interpolation=cv2.INTER_AREA,
        )
        for each in pictures
    ]
    palette = limited(Image.fromarray(np.concatenate([small[0], small[-1]])), COLOURS)
    frames = [limited(Image.fromarray(each), COLOURS, palette) for each in small]
    frames[0].save(
        path,
        format="GIF",
        save_all=True,
        append_images=frames[1:],
        duration=[FRAME_MS] * (len(frames) - 1) + [PAUSE_MS],
        loop=0,
        optimize=False,
    )


def main(arguments: Sequence[str] | None = None) -> None:
    """Draw them."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--scene", type=int, default=1)
    parser.add_argument("--path", type=Path, default=Path("docs/gauze-cutting.png"))
    parser.add_argument("--film", type=Path, default=Path("docs/gauze-cutting.gif"))
    options = parser.parse_args(arguments)
    pictures = columns(options.scene)
    cv2.imwrite(str(options.path), strip(pictures)[..., ::-1])
    write_film(pictures, options.film)


if __name__ == "__main__":
    main()
