"""Who learns nothing, on the final scenes: what the methods' last policies have to be held against.

Such as a way that was planned once and is followed without looking.
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from sheath_manip.evaluation import Report
from sheath_manip.gates import AlwaysExpert
from sheath_manip.metrics import figures_of, record_of
from sheath_manip.plan import LearningPlan
from sheath_manip.protocols import Listener
from sheath_manip.results import plain, write_json
from sheath_manip.rollout import rollout
from sheath_manip.seeding import generator, scene_seed
from sheath_manip.task import TaskEntry
from sheath_manip.types import EpisodeInfo, Purpose


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
        environment = self.task.make_for_run(self.plan.final_variant, self.plan.seeds[0])
        acting = self.task.references[self.name](environment)
        records = []
        for index in range(self.plan.final):
            seed = scene_seed(Purpose.EVALUATION, self.plan.held_out_set, index)
            info = EpisodeInfo(
                task=self.task.name,
                seed=seed,
                purpose=Purpose.EVALUATION,
                control_rate_hz=environment.spec.control_rate_hz,
                method=self.name,
                index=index,
            )
            rng = generator("alone", seed)
            episode = rollout(environment, info, AlwaysExpert(), rng=rng, expert=acting)
            records.append(record_of(episode))
            report(self.name)
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
