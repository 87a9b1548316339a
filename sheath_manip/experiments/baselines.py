"""Baselines that learn nothing, on the final scenes, to hold the methods' last policies against.

Such as a way that was planned once and is followed without looking. In files they are called
references.
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from sheath_manip.experiments.study import Study
from sheath_manip.json_files import plain, write_json
from sheath_manip.learning.config import LearningPlan
from sheath_manip.learning.evaluation import evaluate_expert
from sheath_manip.metrics import figures_of
from sheath_manip.protocols import Listener, Report
from sheath_manip.seeding import scene_seed
from sheath_manip.types import Purpose


@dataclass(frozen=True)
class Baseline:
    """The job of one baseline; resumable."""

    study: Study
    plan: LearningPlan
    runs: Path
    name: str

    def run(self, report: Report, listeners: Sequence[Listener] = ()) -> None:
        """Act in the expert's place on the final scenes, unless that is done."""
        del listeners
        path, comparison = _path(self.runs, self.name), self.plan.comparison
        if path.exists():
            for _ in range(comparison.final_episodes):
                report(self.name)
            return
        environment = self.study.task.make_for_run(comparison.final_variant, comparison.seeds[0])
        acting = self.study.baselines[self.name](environment)
        seeds = [
            scene_seed(Purpose.EVALUATION, comparison.held_out_set, index)
            for index in range(comparison.final_episodes)
        ]
        records = evaluate_expert(environment, acting, self.name, seeds, report)
        environment.close()
        write_json(path, plain(asdict(figures_of(records))))


def baseline_jobs(study: Study, plan: LearningPlan, runs: Path) -> list[Baseline]:
    """Return one job for each baseline of the study."""
    return [Baseline(study, plan, runs, name) for name in study.baselines]


def baseline_figures(study: Study, runs: Path) -> Mapping[str, Any]:
    """Return the figures by name, as far as they are there."""
    paths = {name: _path(runs, name) for name in study.baselines}
    return {name: json.loads(path.read_text()) for name, path in paths.items() if path.exists()}


def _path(runs: Path, name: str) -> Path:
    return runs / "references" / f"{name}.json"
