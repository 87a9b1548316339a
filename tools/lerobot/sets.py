"""Sets in LeRobot's format, written by LeRobot itself, of what the expert said in our episodes.

A chunk of actions to be learned must not cross a change of who acts, nor follow states that the
expert's actions did not lead to. LeRobot takes chunks from within one of its episodes and masks
what lies beyond the end: so each run of steps in which the expert acted is an episode there, and
each labelled step of anybody else's one of a single frame.
"""

from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np

from sheath_manip.types import ACTORS, Actor, Episode, TaskSpec

STATE, ENVIRONMENT, ACTION = "observation.state", "observation.environment_state", "action"


def expert_runs(episode: Episode) -> Iterator[slice]:
    """Return the rows of each episode that LeRobot is to make of this one."""
    columns = episode.columns
    expert = columns.actor == ACTORS.index(Actor.EXPERT)
    first = 0
    for row in range(len(episode)):
        if not columns.has_label[row]:
            first = row + 1
        elif not expert[row] or row + 1 == len(episode) or not expert[row + 1]:
            yield slice(first, row + 1)
            first = row + 1


def write_set(path: Path, episodes: Iterable[Episode], spec: TaskSpec, robot: int) -> int:
    """Write the set anew and return its number of frames.

    Args:
        path: of the set; nothing may be there.
        episodes: whose labels are to be learned.
        spec: of their task.
        robot: how many of the features are the robot's own state; the others are what LeRobot calls
            the environment's.
    """
    from lerobot.datasets.lerobot_dataset import (  # pyright: ignore[reportMissingImports]
        LeRobotDataset,
    )

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
        features = episode.columns.features.astype(np.float32)
        labels = episode.columns.labels.astype(np.float32)
        for rows in expert_runs(episode):
            for seen, label in zip(features[rows], labels[rows], strict=True):
                frame = {STATE: seen[:robot], ENVIRONMENT: seen[robot:], ACTION: label}
                dataset.add_frame({**frame, "task": spec.name})
                frames += 1
            dataset.save_episode()
    dataset.finalize()
    return frames
