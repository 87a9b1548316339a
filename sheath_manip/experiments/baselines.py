"""Non-learning baselines, evaluated on the final scenes for comparison.

Such as a way that was planned once and is followed without looking. In files they are called
references.
"""

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from sheath_manip.experiments.study import Study
from sheath_manip.files.json_files import plain, write_json
from sheath_manip.gates import AlwaysExpert
from sheath_manip.learning.config import LearningPlan
from sheath_manip.learning.evaluation import evaluation_requests
from sheath_manip.metrics import figures_of, record_of
from sheath_manip.protocols import Environment, Expert, Listener, Report
from sheath_manip.rollout.executor import Executor
from sheath_manip.rollout.request import Crew
from sheath_manip.task import Task


@dataclass(frozen=True)
class Baseline:
    """One of the study's baselines, which learns nothing."""

    make: Callable[[Any], Expert]
    """from the environment"""

    def crew(self, task: Task, environment: Environment) -> Crew:
        """Have it act at every step."""
        del task
        return Crew(AlwaysExpert(), expert=self.make(environment))


@dataclass(frozen=True)
class BaselineJob:
    """The job of one baseline; resumable."""

    study: Study
    plan: LearningPlan
    runs: Path
    name: str

    def run(self, executor: Executor, report: Report, listeners: Sequence[Listener] = ()) -> None:
        """Act in the expert's place on the final scenes, unless that is done."""
        del listeners
        path, comparison = _path(self.runs, self.name), self.plan.comparison
        if path.exists():
            for _ in range(comparison.final_episodes):
                report(self.name)
            return
        run_seed, task = comparison.seeds[0], self.study.task
        environment = task.make_for_run(comparison.final_variant, run_seed)
        environment.close()
        requests = evaluation_requests(
            task,
            comparison.final_variant,
            environment.spec,
            Baseline(self.study.baselines[self.name]),
            comparison.held_out_set,
            comparison.final_episodes,
            method=self.name,
            run_seed=run_seed,
        )
        records = [record_of(each) for each in executor.map(requests, report=report)]
        write_json(path, plain(asdict(figures_of(records))))


def baseline_jobs(study: Study, plan: LearningPlan, runs: Path) -> list[BaselineJob]:
    """Return one job for each baseline of the study."""
    return [BaselineJob(study, plan, runs, name) for name in study.baselines]


def baseline_figures(study: Study, runs: Path) -> Mapping[str, Any]:
    """Return the figures by name, as far as they are there."""
    paths = {name: _path(runs, name) for name in study.baselines}
    return {name: json.loads(path.read_text()) for name, path in paths.items() if path.exists()}


def _path(runs: Path, name: str) -> Path:
    return runs / "references" / f"{name}.json"
