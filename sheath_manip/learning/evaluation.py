"""Evaluate a policy or an expert, ungated, on held-out scenes."""

from collections.abc import Iterator
from dataclasses import dataclass

from sheath_manip.counting import counted
from sheath_manip.learning.checkpoint import Checkpoint
from sheath_manip.learning.config import LearningPlan
from sheath_manip.metrics import EpisodeRecord, record_of
from sheath_manip.protocols import Report
from sheath_manip.rollout.executor import Executor
from sheath_manip.rollout.request import Driver, EpisodeRequest
from sheath_manip.seeding import scene_seed
from sheath_manip.task import Task
from sheath_manip.types import EpisodeInfo, Purpose, TaskSpec


def evaluation_requests(
    task: Task,
    variant: str,
    spec: TaskSpec,
    driver: Driver,
    scenes: str,
    count: int,
    *,
    method: str = "",
    number: int = 0,
    run_seed: int = 0,
) -> list[EpisodeRequest]:
    """Return requests for `driver` on the first scenes of a held-out set.

    Nothing is recorded or learned from them, and all methods, seeds and rounds meet the same.

    Args:
        task: which task.
        variant: of the task; one of its `run_variants` is that of the run.
        spec: of the task.
        driver: who drives, such as `PolicyAlone` or `ExpertAlone`.
        scenes: name of the set; tune on another than you report.
        count: how many.
        method: that the driver learned by, or its name.
        number: of the round that it was fitted in.
        run_seed: of the training run.
    """
    infos = [
        EpisodeInfo.of(
            spec,
            variant=variant,
            seed=scene_seed(Purpose.EVALUATION, scenes, index),
            purpose=Purpose.EVALUATION,
            method=method,
            round=number,
            index=index,
            run_seed=run_seed,
        )
        for index in range(count)
    ]
    return [EpisodeRequest(task, info, driver) for info in infos]


@dataclass(frozen=True, eq=False)
class Evaluation:
    """Policies alone on a plan's held-out scenes, the same for every method, seed and round."""

    task: Task
    plan: LearningPlan
    spec: TaskSpec
    executor: Executor
    report: Report

    def of(
        self, driver: Driver, fitted: Checkpoint, final: bool = False
    ) -> Iterator[EpisodeRecord]:
        """Evaluate `driver`, the policy of `fitted`; `final` on the scenes for last policies.

        The episodes run when they are asked for, or from now on where the executor overlaps.
        """
        comparison = self.plan.comparison
        requests = evaluation_requests(
            self.task,
            comparison.final_variant if final else self.plan.schedule.variant,
            self.spec,
            driver,
            comparison.held_out_set,
            comparison.final_episodes if final else comparison.evaluation_episodes,
            method=fitted.method,
            number=fitted.round,
            run_seed=fitted.run_seed,
        )
        records = map(record_of, self.executor.map(requests, report=self.report))
        return counted(records, len(requests))
