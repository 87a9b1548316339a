"""Episodes in memory, of an expert and of a policy under its gate: what first tries begin with."""

import numpy as np

from sheath_manip.exceptions import ParameterError
from sheath_manip.learning.checkpoint import Checkpoint
from sheath_manip.learning.drivers import ExpertAlone
from sheath_manip.rollout.loop import rollout
from sheath_manip.rollout.request import EpisodeRequest
from sheath_manip.rollout.serial import SerialExecutor
from sheath_manip.seeding import scene_seed
from sheath_manip.task import Task
from sheath_manip.types import Episode, EpisodeInfo, Purpose, TaskSpec


def demonstrations(
    task: Task, count: int, variant: str = "default", seed: int = 0
) -> list[Episode]:
    """Return `count` episodes that the scripted expert drives, every step labelled.

    They are those that `sheath collect` records.

    Args:
        task: whose expert drives.
        count: of episodes, each in a scene of its own.
        variant: of the task.
        seed: from which the scenes follow.
    """
    environment = _task(task).make(variant)
    spec = environment.spec
    environment.close()
    requests = [
        EpisodeRequest(task, demonstration_info(spec, variant, seed, index), ExpertAlone())
        for index in range(count)
    ]
    with SerialExecutor() as executor:
        return list(executor.map(requests))


def demonstration_info(spec: TaskSpec, variant: str, seed: int, index: int) -> EpisodeInfo:
    """Return the info of the demonstration number `index` of those that follow from `seed`."""
    return EpisodeInfo.of(
        spec,
        variant=variant,
        seed=scene_seed(Purpose.DEMONSTRATION, seed, 0, index),
        purpose=Purpose.DEMONSTRATION,
        # Another variant is another scene, though its seed be the same.
        method="expert" if variant == "default" else f"expert-{variant}",
        index=index,
        run_seed=seed,
    )


def gated_episode(
    task: Task, checkpoint: Checkpoint, variant: str = "default", seed: int = 0
) -> Episode:
    """Return an episode that the policy of `checkpoint` drives under its gate.

    Where the gate does not trust it, the scripted expert takes over and labels.

    Args:
        task: of the checkpoint.
        checkpoint: which lies in no file.
        variant: of the task.
        seed: of the scene, and of what gate and policy draw.
    """
    environment = _task(task).make(variant)
    try:
        return rollout(
            environment,
            EpisodeInfo.of(
                environment.spec,
                variant=variant,
                seed=scene_seed(Purpose.LEARNING, "first", seed),
                purpose=Purpose.LEARNING,
                method=checkpoint.method or "first",
                run_seed=seed,
            ),
            checkpoint.gate(),
            rng=np.random.default_rng(seed),
            policy=checkpoint.policy,
            expert=task.expert(environment),
        )
    finally:
        environment.close()


def _task(task: Task) -> Task:
    if not isinstance(task, Task):
        raise ParameterError(
            f"the task is {task!r}; wanted a Task, such as TASKS['driving'] of "
            "sheath_manip.tasks.table"
        )
    return task
