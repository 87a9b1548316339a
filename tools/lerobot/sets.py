"""Sets in LeRobot's format, written by LeRobot itself, of what the expert said in our episodes.

A chunk of actions to be learned must not cross a change of who acts, nor follow states that the
expert's actions did not lead to. LeRobot takes chunks from within one of its episodes and masks
what lies beyond the end: so each run of steps in which the expert acted is an episode there, and
every fifth labelled step of anybody else's one of a single frame: LeRobot takes 50 ms to save an
episode, however short, and what lies 50 ms apart looks alike.
"""

import shutil
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

import numpy as np

from sheath_manip.metrics import runs_of
from sheath_manip.types import ACTORS, Actor, Columns, Episode, TaskSpec

STATE, ENVIRONMENT, ACTION = "observation.state", "observation.environment_state", "action"


EVERY = 5
"""how many steps of the policy's there are to one that is learned from"""


def parts(columns: Columns) -> Iterator[slice]:
    """Return the rows of each episode that LeRobot is to make of one of ours."""
    expert = columns.actor == ACTORS.index(Actor.EXPERT)
    for first, after in runs_of(columns.has_label & expert):
        yield slice(first, after)
    for row in np.flatnonzero(columns.has_label & ~expert)[::EVERY]:
        yield slice(int(row), int(row) + 1)


def write_set(path: Path, episodes: Iterable[Episode], spec: TaskSpec, robot: int) -> int:
    """Write the set anew and return its number of frames; of none LeRobot wants no set.

    Args:
        path: of the set; what an interrupted run left there is thrown away.
        episodes: whose labels are to be learned.
        spec: of their task.
        robot: how many of the features are the robot's own state; the others are what LeRobot calls
            the environment's.
    """
    from lerobot.datasets.lerobot_dataset import (  # pyright: ignore[reportMissingImports]
        LeRobotDataset,
    )

    shutil.rmtree(path, ignore_errors=True)
    widths = {
        STATE: robot,
        ENVIRONMENT: len(spec.feature_names) - robot,
        ACTION: len(spec.action.names),
    }
    dataset = LeRobotDataset.create(
        repo_id=f"local/{path.name}",
        fps=round(spec.control_rate_hz),
        features={
            name: {"dtype": "float32", "shape": (width,), "names": None}
            for name, width in widths.items()
        },
        root=path,
        use_videos=False,
    )
    frames = 0
    for episode in episodes:
        columns = episode.columns
        features, labels = columns.features.astype(np.float32), columns.labels.astype(np.float32)
        for rows in parts(columns):
            for seen, label in zip(features[rows], labels[rows], strict=True):
                frame = {STATE: seen[:robot], ENVIRONMENT: seen[robot:], ACTION: label}
                dataset.add_frame({**frame, "task": spec.name})
                frames += 1
            dataset.save_episode()
    dataset.finalize()
    if not frames:
        shutil.rmtree(path)
    return frames


def join_sets(sets: Sequence[Path], out: Path) -> Path:
    """Return the set that LeRobot makes of several, or the only one."""
    from lerobot.datasets.aggregate import (  # pyright: ignore[reportMissingImports]
        aggregate_datasets,
    )

    if len(sets) == 1:
        return sets[0]
    shutil.rmtree(out, ignore_errors=True)
    names = [f"local/{path.name}" for path in sets]
    aggregate_datasets(names, f"local/{out.name}", roots=list(sets), aggr_root=out)
    return out
