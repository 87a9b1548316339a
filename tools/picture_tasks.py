"""One picture of each task, all of one size, as films show it.

    python -m tools.picture_tasks [--tasks driving grasp-clutter ...] [--folder docs]

shows the expert's episode in a tuning scene, at a moment at which there is something to see.
"""

import argparse
from collections.abc import Sequence
from pathlib import Path

from PIL import Image

from sheath_manip.playback.gif import limited
from sheath_manip.seeding import scene_seed
from sheath_manip.tasks.table import TASKS
from sheath_manip.types import Purpose

WIDTH_PX, HEIGHT_PX = 720, 360
MOMENTS = {"driving": 40, "platformer": 90, "grasp-clutter": 70, "gauze-cutting": 130}
"""by task, in control steps"""
COLOURS = 128


def main(arguments: Sequence[str] | None = None) -> None:
    """Play, draw and write."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--tasks", nargs="+", default=list(MOMENTS))
    parser.add_argument("--folder", type=Path, default=Path("docs"))
    options = parser.parse_args(arguments)
    for name in options.tasks:
        task = TASKS[name]
        assert task.picture is not None
        environment = task.make()
        expert = task.expert(environment)
        observation = environment.reset(scene_seed(Purpose.EVALUATION, "tuning", 1))
        expert.reset()
        for _ in range(MOMENTS[name]):
            observation = environment.step(expert.act(observation)).observation
        picture = Image.fromarray(task.picture(environment))
        environment.close()
        sized = picture.resize((WIDTH_PX, HEIGHT_PX), Image.Resampling.LANCZOS)
        limited(sized, COLOURS).save(options.folder / f"{name}.png", optimize=True)


if __name__ == "__main__":
    main()
