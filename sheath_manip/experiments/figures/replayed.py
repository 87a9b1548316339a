"""Pictures of steps as no camera saw them: their states are restored and looked at afterwards."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sheath_manip.experiments.figures.intervention import Pictures, recorded
from sheath_manip.protocols import require_restorable
from sheath_manip.task import Task
from sheath_manip.types import Episode


def pictures_of(task: Task, variant: str) -> Pictures:
    """The entry's `picture` of episodes, or the recorded images where it has none.

    `variant` is that of old episodes, which do not say theirs.
    """
    picture = task.picture
    if picture is None:
        return recorded

    def pictures(episode: Episode, indices: Sequence[int]) -> Sequence[NDArray[np.uint8]]:
        # Each training run may have a scene of its own.
        environment = task.make_for_run(episode.info.variant or variant, episode.info.run_seed)
        try:
            return replayed(environment, picture, episode, indices)
        finally:
            environment.close()

    return pictures


def replayed(
    environment: Any,
    picture: Callable[[Any], NDArray[np.uint8]],
    episode: Episode,
    indices: Sequence[int],
) -> Sequence[NDArray[np.uint8]]:
    """A `picture` of each of those moments, in the `environment` of the episode's training run."""
    environment.reset(episode.info.seed)
    states = (*(step.state for step in episode.steps), episode.final_state)
    found, restorable = [], require_restorable(environment, "pictures of recorded steps")
    for index in indices:
        restorable.restore(states[index])
        found.append(picture(environment))
    return found
