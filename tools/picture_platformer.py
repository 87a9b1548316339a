"""The README's picture of the platformer.

    python -m tools.picture_platformer [--seed 2] [--step 60] [--path docs/platformer.png]

shows the expert at that step of the stage of that seed, and below it the stage as a whole.
"""

import argparse
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from PIL import Image

from tasks.composer_environment import ComposerEnvironment
from tasks.platformer.expert import PlatformerExpert
from tasks.platformer.figures import frame, whole_stage
from tasks.platformer.task import PlatformerTask, Scenario

WIDTH_PX, FRAME_HEIGHT_PX, STRIPS = 1200, 480, 2
COLOURS = 32


def main(arguments: Sequence[str] | None = None) -> None:
    """Play, draw and write."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seed", type=int, default=2)
    parser.add_argument("--step", type=int, default=60)
    parser.add_argument("--path", type=Path, default=Path("docs/platformer.png"))
    options = parser.parse_args(arguments)
    environment = ComposerEnvironment(PlatformerTask(Scenario()))
    expert, observation = PlatformerExpert(environment), environment.reset(options.seed)
    for _ in range(options.step):
        observation = environment.step(expert.act(observation)).observation
    pictures = [
        frame(environment, WIDTH_PX, FRAME_HEIGHT_PX),
        np.zeros((4, WIDTH_PX, 3), np.uint8),
        whole_stage(environment, WIDTH_PX, STRIPS),
    ]
    environment.close()
    picture = Image.fromarray(np.concatenate(pictures)).quantize(COLOURS)
    options.path.parent.mkdir(parents=True, exist_ok=True)
    picture.save(options.path, optimize=True)


if __name__ == "__main__":
    main()
