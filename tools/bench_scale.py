"""How an experiment fills many cores: its schedule, and whether its cost is what was predicted.

    python -m tools.bench_scale [--quick] [--results DIRECTORY]

writes bench-scale.json, which `sheath claims` reads. A small run of each task measures what its
pieces cost in CPU seconds on one thread. From these the schedules of driving's full plan and of a
million frames are simulated, and the CPU seconds of quick plans are predicted, which are then run
with 1, 2 and 4 workers: CPU seconds are nearly the same on a busy machine. The processes of workers
count in full, with their start. How much sooner two workers are through than one core only the
clock can tell, so that line comes first, and wants a machine with nothing else to do and two cores
that do not slow each other down. --quick takes a toy's size, to see that it runs.
"""

import os
import resource
import tempfile
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.experiments.learning import PREPARE, Job, next_jobs
from sheath_manip.experiments.scale.costs import Costs, measure_costs
from sheath_manip.experiments.scale.estimate import moved, speedup
from sheath_manip.experiments.scale.schedule import Machines, longest_chain_s, wall_s
from sheath_manip.experiments.scale.work import Work, work_of
from sheath_manip.experiments.study import Study
from sheath_manip.experiments.workers import run_jobs
from sheath_manip.learning.beforehand import with_final_variant
from sheath_manip.learning.config import LearningPlan
from sheath_manip.rollout.executing import Executing
from sheath_manip.tasks.table import STUDIES
from tools.bench import Line, at_least, at_most, run_bench

FASTER = "times as fast as one"
TOO_FAR = 0.3
"""of the measured CPU seconds, by which a prediction may be wrong"""
START_S = 4.0
"""CPU seconds that a process takes until it has imported what it works with and made driving's
environment; measured by hand, the half of it torch"""


MILLION = {
    "schedule": {"rounds": 8, "episodes": 500},
    "comparison": {"methods": ("sheath",), "seeds": (0,)},
}
"""changes of driving's plan: 4000 episodes of some 250 frames"""
SIDE_BY_SIDE = {
    "schedule": {"rounds": 3, "episodes": 12},
    "comparison": {"seeds": (0, 1), "evaluation_episodes": 12},
}
"""changes of the quick plan, so that the start of processes is no large part of the run"""


@dataclass(frozen=True)
class Sizes:
    """How much is measured."""

    scheduled: str
    """plan of driving whose schedule is simulated"""
    side_by_side: Mapping[str, Mapping[str, Any]]
    """changes of driving's quick plan that is run on one core and on two"""
    predicted: Mapping[str, str]
    """by task, the plan whose cost is predicted and measured"""
    workers: tuple[int, ...]


FULL = Sizes("full", SIDE_BY_SIDE, {"driving": "quick", "platformer": "quick"}, (1, 2, 4))
QUICK = Sizes("quick", {"comparison": {"methods": ("dagger",)}}, {}, (1,))


def schedule_lines(sizes: Sizes) -> dict[str, Line]:
    """How many times as fast as one core driving's plans are on many."""
    study = STUDIES["driving"]
    plan = study.plan(sizes.scheduled)
    costs = costs_of(study, plan)
    work = work_of(costs, plan)
    lines = {}
    for cores, least in ((2, 1.8), (8, 6.0), (64, 20.0)):
        title = f"driving, {sizes.scheduled} plan, schedule on {cores} cores"
        lines[title] = at_least(speedup(work, Machines(cores)), least, FASTER, _told(work))
    many = plan.changed(**MILLION)
    costs = replace(costs, methods={"sheath": costs.methods["sheath"]})
    work = work_of(costs, many)
    travels_gb = moved(costs, many).episodes_b / 1e9
    for cores, devices, most_h in ((1, 0, 96.0), (8, 0, 24.0), (64, 0, 24.0), (64, 1, 12.0)):
        title = f"a million frames on {cores} cores" + ", 1 device that fits" * devices
        hours = wall_s(work, Machines(cores, devices)) / 3600
        how = f"{_told(work)}; {travels_gb:.1f} GB of episodes travel"
        lines[title] = at_most(hours, most_h, "hours, simulated", how)
    return lines


def _told(work: Sequence[Work]) -> str:
    total_s, chain_s = sum(piece.cpu_s for piece in work), longest_chain_s(work)
    return f"{len(work)} pieces, {total_s:.0f} CPU s, of which the longest chain {chain_s:.0f}"


def side_by_side_line(sizes: Sizes) -> dict[str, Line]:
    """How much sooner two workers on two cores are through than one process on one core."""
    study = STUDIES["driving"]
    plan = study.plan("quick").changed(**sizes.side_by_side)
    cores = sorted(os.sched_getaffinity(0))
    if len(cores) < 2:
        return {}
    os.sched_setaffinity(0, cores[:1])
    one = run_s(study, plan, workers=0)
    os.sched_setaffinity(0, cores[:2])
    two = run_s(study, plan, workers=2)
    os.sched_setaffinity(0, cores)
    how = (
        f"driving, {one.clock_s:.0f} s by the clock on one core and {two.clock_s:.0f} s on two; "
        f"{one.cpu_s:.0f} and {two.cpu_s:.0f} CPU s, the start of processes included"
    )
    return {"two workers, measured": at_least(one.clock_s / two.clock_s, 1.8, FASTER, how)}


def prediction_lines(sizes: Sizes) -> dict[str, Line]:
    """How far the CPU seconds of a run are from those that were predicted."""
    lines = {}
    for name, size in sizes.predicted.items():
        study = STUDIES[name]
        plan = study.plan(size)
        predicted_s = sum(piece.cpu_s for piece in work_of(costs_of(study, plan), plan))
        for workers in sizes.workers:
            measured_s = run_s(study, plan, workers).cpu_s
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


@dataclass(frozen=True)
class Spent:
    """What a run took."""

    cpu_s: float
    """of all processes"""
    clock_s: float


def run_s(study: Study, plan: LearningPlan, workers: int) -> Spent:
    """Run the rounds, without summary and figures."""
    plan = with_final_variant(study.task, plan)
    with tempfile.TemporaryDirectory() as directory:
        runs = Path(directory)
        EpisodeStore.create(runs / "store")
        jobs = [Job(study.task, plan, runs, seed, PREPARE) for seed in plan.comparison.seeds]
        begin_s, began_s = _spent_s(), time.perf_counter()
        run_jobs(jobs, next_jobs, Executing(workers=workers), lambda _: None)
        return Spent(_spent_s() - begin_s, time.perf_counter() - began_s)


def _spent_s() -> float:
    ended = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.process_time() + ended.ru_utime + ended.ru_stime


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure, print a line a number, write the file."""
    measures = (side_by_side_line, schedule_lines, prediction_lines)
    run_bench("scale", __doc__, measures, FULL, QUICK, arguments)


if __name__ == "__main__":
    main()
