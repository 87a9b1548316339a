"""How an experiment fills many cores: its schedule, and whether its cost is what was predicted.

    python -m tools.bench_scale [--quick] [--results DIRECTORY]

writes bench-scale.json, which `sheath claims` reads. A small run of each task measures what its
pieces cost in CPU seconds on one thread. From these the schedule of driving's full plan is
simulated, and the CPU seconds of quick plans are predicted, which are then run with 1, 2 and 4
workers: CPU seconds are the same on a busy machine. The processes of workers count in full, with
their start. --quick takes a toy's size, to see that it runs.
"""

import resource
import tempfile
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.experiments.learning import PREPARE, Job, next_jobs
from sheath_manip.experiments.scale.costs import Costs, measure_costs
from sheath_manip.experiments.scale.estimate import speedup
from sheath_manip.experiments.scale.schedule import Machines, longest_chain_s
from sheath_manip.experiments.scale.work import work_of
from sheath_manip.experiments.study import Study
from sheath_manip.experiments.workers import run_jobs
from sheath_manip.learning.beforehand import with_final_variant
from sheath_manip.learning.config import LearningPlan
from sheath_manip.rollout.executing import Executing
from sheath_manip.tasks.table import STUDIES
from tools.bench import Line, at_least, at_most, run_bench

TOO_FAR = 0.3
"""of the measured CPU seconds, by which a prediction may be wrong"""
START_S = 4.0
"""CPU seconds that a process takes until it has imported what it works with and made driving's
environment; measured by hand, the half of it torch"""


@dataclass(frozen=True)
class Sizes:
    """How much is measured."""

    scheduled: str
    """plan of driving whose schedule is simulated"""
    predicted: Mapping[str, str]
    """by task, the plan whose cost is predicted and measured"""
    workers: tuple[int, ...]


FULL = Sizes("full", {"driving": "quick", "platformer": "quick"}, (1, 2, 4))
QUICK = Sizes("quick", {}, (1,))


def schedule_lines(sizes: Sizes) -> dict[str, Line]:
    """How many times as fast as one core the plan is on 8 and on 64."""
    study = STUDIES["driving"]
    plan = study.plan(sizes.scheduled)
    work = work_of(costs_of(study, plan), plan)
    total_s, chain_s = sum(piece.cpu_s for piece in work), longest_chain_s(work)
    lines = {}
    for cores, least in ((2, 1.8), (8, 6.0), (64, 20.0)):
        how = f"{len(work)} pieces, {total_s:.0f} CPU s, of which the longest chain {chain_s:.0f}"
        lines[f"driving, {sizes.scheduled} plan, schedule on {cores} cores"] = at_least(
            speedup(work, Machines(cores)), least, "times as fast as one", how
        )
    return lines


def prediction_lines(sizes: Sizes) -> dict[str, Line]:
    """How far the CPU seconds of a run are from those that were predicted."""
    lines = {}
    for name, size in sizes.predicted.items():
        study = STUDIES[name]
        plan = study.plan(size)
        predicted_s = sum(piece.cpu_s for piece in work_of(costs_of(study, plan), plan))
        for workers in sizes.workers:
            measured_s = run_s(study, plan, workers)
            started_s = START_S * processes(plan, workers)
            how = f"{predicted_s + started_s:.0f} CPU s predicted, {measured_s:.0f} measured"
            off = abs(predicted_s + started_s - measured_s) / measured_s
            lines[f"{name}, {size} plan, prediction for {workers} workers"] = at_most(
                off, TOO_FAR, "of the measured", how
            )
    return lines


def costs_of(study: Study, plan: LearningPlan) -> Costs:
    """The costs of the plan's pieces, measured now."""
    with tempfile.TemporaryDirectory() as directory:
        plan = with_final_variant(study.task, plan)
        return measure_costs(study.task, plan, Path(directory), lambda _: None)


def processes(plan: LearningPlan, workers: int) -> int:
    """How many processes a run starts: for episodes, and for jobs."""
    jobs = len(plan.comparison.seeds) * len(plan.comparison.methods)
    return workers + min(workers, jobs)


def run_s(study: Study, plan: LearningPlan, workers: int) -> float:
    """CPU seconds of all processes of the rounds, without summary and figures."""
    plan = with_final_variant(study.task, plan)
    with tempfile.TemporaryDirectory() as directory:
        runs = Path(directory)
        EpisodeStore.create(runs / "store")
        jobs = [Job(study.task, plan, runs, seed, PREPARE) for seed in plan.comparison.seeds]
        begin_s = _spent_s()
        run_jobs(jobs, next_jobs, Executing(workers=workers), lambda _: None)
        return _spent_s() - begin_s


def _spent_s() -> float:
    ended = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.process_time() + ended.ru_utime + ended.ru_stime


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure, print a line a number, write the file."""
    run_bench("scale", __doc__, (schedule_lines, prediction_lines), FULL, QUICK, arguments)


if __name__ == "__main__":
    main()
