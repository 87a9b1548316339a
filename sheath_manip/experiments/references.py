"""Who learns nothing, on the final scenes: what the methods' last policies have to be held against.

Such as a way that was planned once and is followed without looking.
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from sheath_manip.json_files import plain, write_json
from sheath_manip.learning.config import LearningPlan
from sheath_manip.learning.evaluation import evaluate_expert
from sheath_manip.metrics import figures_of
from sheath_manip.protocols import Listener, Report
from sheath_manip.seeding import scene_seed
from sheath_manip.task import TaskEntry
from sheath_manip.types import Purpose


@dataclass(frozen=True)
class Reference:
    """The job of one of them; resumable."""

    task: TaskEntry
    plan: LearningPlan
    runs: Path
    name: str

    def run(self, report: Report, listeners: Sequence[Listener] = ()) -> None:
        """Act in the expert's place on the final scenes, unless that is done."""
        del listeners
        path = _path(self.runs, self.name)
        if path.exists():
            for _ in range(self.plan.final):
                report(self.name)
            return
        variant = self.plan.final_variant
        environment = self.task.make_for_run(variant, self.plan.seeds[0])
        acting = self.task.references[self.name](environment)
        held_out = self.plan.held_out_set
        seeds = [scene_seed(Purpose.EVALUATION, held_out, i) for i in range(self.plan.final)]
        records = evaluate_expert(environment, variant, acting, self.name, seeds, report)
        environment.close()
        write_json(path, plain(asdict(figures_of(records))))


def reference_jobs(task: TaskEntry, plan: LearningPlan, runs: Path) -> list[Reference]:
    """One for each of the task's."""
    return [Reference(task, plan, runs, name) for name in task.references]


def references(task: TaskEntry, runs: Path) -> Mapping[str, Any]:
    """Figures by name, as far as they are there."""
    paths = {name: _path(runs, name) for name in task.references}
    return {name: json.loads(path.read_text()) for name, path in paths.items() if path.exists()}


def _path(runs: Path, name: str) -> Path:
    return runs / "references" / f"{name}.json"
