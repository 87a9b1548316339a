"""The README's film strip of the grasp in clutter.

    python -m tools.picture_grasp_clutter [--scene 3] [--path docs/grasp-clutter.png]

shows the expert's episode in that tuning scene at five moments: from the front, and below it what
the policy sees over the shoulder and from the wrist.
"""

import argparse
from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from sheath_manip.seeding import scene_seed
from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.grasp_clutter.expert import GraspExpert
from sheath_manip.tasks.grasp_clutter.task import GraspTask, Scenario
from sheath_manip.tasks.rendering import PyramidCamera
from sheath_manip.types import Observation, Purpose

MOMENTS = 5
RENDERED_PX = 480
SHOWN_PX = 360
GAP_PX = 6


def _panel(front: NDArray[np.uint8], observation: Observation) -> NDArray[np.uint8]:
    large = cv2.resize(front, (SHOWN_PX, SHOWN_PX), interpolation=cv2.INTER_AREA)
    size = (SHOWN_PX // 2, SHOWN_PX // 2)
    small = [
        cv2.resize(observation.images[name], size, interpolation=cv2.INTER_NEAREST)
        for name in ("shoulder", "wrist")
    ]
    panel = np.concatenate([large, np.concatenate(small, axis=1)])
    return np.pad(panel, ((0, 0), (0, GAP_PX), (0, 0)), constant_values=255).astype(np.uint8)


def main(arguments: Sequence[str] | None = None) -> None:
    """Play, draw and write."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--scene", type=int, default=3)
    parser.add_argument("--path", type=Path, default=Path("docs/grasp-clutter.png"))
    options = parser.parse_args(arguments)
    task = GraspTask(Scenario(cameras=("shoulder", "wrist")))
    environment = ComposerEnvironment(task)
    camera = PyramidCamera(task.camera_name("front"), RENDERED_PX, pyramid_levels=0)
    expert = GraspExpert(environment)
    observation = environment.reset(scene_seed(Purpose.EVALUATION, "tuning", options.scene))
    expert.reset()
    panels, ended = [_panel(camera(environment.physics), observation)], False
    while not ended:
        transition = environment.step(expert.act(observation))
        observation = transition.observation
        panels.append(_panel(camera(environment.physics), observation))
        ended = transition.terminated or transition.truncated
    shown = np.linspace(0, len(panels) - 1, MOMENTS).astype(int)
    strip = np.concatenate([panels[index] for index in shown], axis=1)[:, :-GAP_PX]
    options.path.parent.mkdir(parents=True, exist_ok=True)
    cv2.imwrite(str(options.path), cv2.cvtColor(strip, cv2.COLOR_RGB2BGR))
    environment.close()


if __name__ == "__main__":
    main()
