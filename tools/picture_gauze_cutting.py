"""The README's film strip of gauze cutting.

    python -m tools.picture_gauze_cutting [--scene 1] [--path docs/gauze-cutting.png]

shows the expert's episode in that tuning scene: the sheet before, half cut, and the disc falling;
below it what the policy sees.
"""

import argparse
from collections.abc import Sequence
from pathlib import Path

import cv2
import mujoco
import numpy as np
from numpy.typing import NDArray

from sheath_manip.seeding import scene_seed
from sheath_manip.types import Observation, Purpose
from tasks.composer_environment import ComposerEnvironment
from tasks.gauze_cutting.expert import GauzeExpert
from tasks.gauze_cutting.task import CAMERA, GauzeTask
from tasks.rendering import PyramidCamera

RENDERED_PX = 600
SHOWN_PX = 420
GAP_PX = 6
HALF_CUT_S = 4.0
FALLING_STEPS = (6, 14)
"""of the physics, after the disc has come free"""


def film_strip(scene: int) -> NDArray[np.uint8]:
    """(h, w, 3) RGB of tuning scene number `scene`, from before the cut to the falling disc."""
    environment = ComposerEnvironment(GauzeTask())
    expert = GauzeExpert(environment)
    shown = PyramidCamera("side", RENDERED_PX, pyramid_levels=0)
    observation = environment.reset(scene_seed(Purpose.EVALUATION, "tuning", scene))
    columns, ended = [], False
    columns.append(_column(shown(environment.physics), observation))
    while not ended:
        transition = environment.step(expert.act(observation))
        observation, ended = transition.observation, transition.terminated or transition.truncated
        if abs(observation.time_s - HALF_CUT_S) < 1e-6:
            columns.append(_column(shown(environment.physics), observation))
    steps = 0
    for until in FALLING_STEPS:
        while steps < until:
            environment.physics.step()
            steps += 1
        model, data = environment.physics.model.ptr, environment.physics.data.ptr
        mujoco.mj_forward(model, data)
        columns.append(_column(shown(environment.physics), environment.observe()))
    environment.close()
    gap = np.full((columns[0].shape[0], GAP_PX, 3), 255, np.uint8)
    strip = [part for column in columns for part in (gap, column)][1:]
    return np.concatenate(strip, axis=1)


def _column(picture: NDArray[np.uint8], observation: Observation) -> NDArray[np.uint8]:
    size = (SHOWN_PX, SHOWN_PX)
    above = cv2.resize(picture, size, interpolation=cv2.INTER_AREA)
    seen = cv2.resize(observation.images[CAMERA], size, interpolation=cv2.INTER_NEAREST)
    gap = np.full((GAP_PX, SHOWN_PX, 3), 255, np.uint8)
    return np.concatenate([above, gap, seen]).astype(np.uint8)


def main(arguments: Sequence[str] | None = None) -> None:
    """Draw it."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--scene", type=int, default=1)
    parser.add_argument("--path", type=Path, default=Path("docs/gauze-cutting.png"))
    options = parser.parse_args(arguments)
    cv2.imwrite(str(options.path), film_strip(options.scene)[..., ::-1])


if __name__ == "__main__":
    main()
