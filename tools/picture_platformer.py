"""The README's picture of the platformer.

    python -m tools.picture_platformer [--seed 2] [--step 60] [--path docs/platformer.png]

shows the expert at that step of the stage of that seed, and below it the stage as a whole.
"""

import argparse
from collections.abc import Sequence
from pathlib import Path

from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.platformer.expert import PlatformerExpert
from sheath_manip.tasks.platformer.study.figures import write_scene
from sheath_manip.tasks.platformer.task import PlatformerTask, Scenario

WIDTH_PX = 1200


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
    write_scene(environment, options.path, WIDTH_PX)
    environment.close()


if __name__ == "__main__":
    main()
