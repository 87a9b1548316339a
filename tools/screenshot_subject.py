"""What is photographed: a task, with a policy under its gate or the expert alone."""

import argparse
from dataclasses import dataclass
from pathlib import Path

from sheath_manip.cli.adjusting import Adjusting, adjusted, scenes_of
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.learning.checkpoint import Checkpoint, load_checkpoint
from sheath_manip.learning.drivers import ExpertAlone
from sheath_manip.learning.run import LearningRun
from sheath_manip.rollout.request import Driver, EpisodeRequest
from sheath_manip.rollout.serial import SerialExecutor
from sheath_manip.seeding import scene_seed
from sheath_manip.task import Task
from sheath_manip.tasks.table import STUDIES
from sheath_manip.types import EpisodeInfo, Purpose, TaskSpec


@dataclass(frozen=True)
class Subject:
    """What is photographed."""

    task: Task
    spec: TaskSpec
    checkpoint: Checkpoint | None = None
    """None: the expert alone"""
    adjusting: Adjusting | None = None
    """the checkpoint's policy under its gate, and the gate's sliders"""

    @property
    def driver(self) -> Driver:
        """Who drives where there is no person."""
        return ExpertAlone() if self.adjusting is None else self.adjusting.driver

    def request(self, driver: Driver, method: str, index: int) -> EpisodeRequest:
        """An episode in a scene that no experiment has."""
        info = EpisodeInfo.of(
            self.spec,
            variant="default",
            seed=scene_seed(Purpose.LEARNING, "screenshot", index),
            purpose=Purpose.LEARNING,
            method=method,
            round=0 if self.checkpoint is None else self.checkpoint.round + 1,
            index=index,
        )
        return EpisodeRequest(self.task, info, driver)


def trained(task: Task, folder: Path) -> tuple[Path, Path]:
    """A policy and its gate from a few demonstrations: their file, and the store."""
    quick = STUDIES[task.name].plan("quick")
    plan = quick.changed(
        schedule={"false_alarm_episodes": 1},
        comparison={"evaluation_episodes": 1, "final_episodes": 1},
    )
    store = EpisodeStore.create(folder / "training")
    with SerialExecutor() as executor:
        start = LearningRun(task, plan, 0, folder, store, executor).start()
    return start.checkpoints.path(start.checkpoint), store.path


def subject_of(task: Task, options: argparse.Namespace, spec: TaskSpec, folder: Path) -> Subject:
    """Read, trained, or the expert."""
    if options.expert:
        return Subject(task, spec)
    path, store = options.checkpoint, options.store
    if path is None:
        path, store = trained(task, folder)
    checkpoint = load_checkpoint(path, spec)
    return Subject(task, spec, checkpoint, adjusted(path, checkpoint, store, spec, scenes_of(task)))
