"""`sheath experiment NAME --estimate`: how long it takes on how many cores and devices."""

import dataclasses
import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console
from rich.table import Table

from sheath_manip.exceptions import StoreError
from sheath_manip.experiments.scale.costs import Costs, Line, MethodCosts, measure_costs
from sheath_manip.experiments.scale.schedule import Machines, longest_chain_s, wall_s
from sheath_manip.experiments.scale.work import Work, work_of
from sheath_manip.experiments.study import Study
from sheath_manip.files.json_files import write_json
from sheath_manip.learning.beforehand import with_final_variant
from sheath_manip.learning.config import LearningPlan
from sheath_manip.learning.resuming import require_same_plan
from sheath_manip.protocols import Report

CORES = (1, 2, 4, 8, 16, 32, 64)
DEVICES = (0, 1, 4)


@dataclass(frozen=True)
class Moved:
    """What travels between machines where the workers are others than the one that fits."""

    episodes_b: float
    """recorded episodes, from the workers"""
    checkpoints_b: float
    """checkpoints, to each machine"""


def estimated_costs(study: Study, plan: LearningPlan, directory: Path, report: Report) -> Costs:
    """Return the costs of the plan's pieces: those of its trial in `directory`, or measure them."""
    plan = with_final_variant(study.task, plan)
    directory.mkdir(parents=True, exist_ok=True)
    require_same_plan(plan.described(), directory / "plan.json")
    path = directory / "costs.json"
    if not path.exists():
        costs = measure_costs(study.task, plan, _new(directory), report)
        write_json(path, dataclasses.asdict(costs))
    return read_costs(path)


def read_costs(path: Path) -> Costs:
    """Read what was measured; raises StoreError where that is no such thing."""
    try:
        content = json.loads(path.read_text())
        methods = {
            name: MethodCosts(**{**each, "fit": Line(**each["fit"])})
            for name, each in content["methods"].items()
        }
        return Costs(**{**content, "fit": Line(**content["fit"]), "methods": methods})
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise StoreError(
            f"{path} holds no costs ({error}); remove it to have them measured again"
        ) from error


def moved(costs: Costs, plan: LearningPlan) -> Moved:
    """Return what travels."""
    schedule, comparison = plan.schedule, plan.comparison
    expert = schedule.demonstrations + schedule.calibration + schedule.false_alarm_episodes
    driven = len(comparison.methods) * schedule.rounds
    return Moved(
        len(comparison.seeds) * (expert + driven * schedule.episodes) * costs.episode_b,
        len(comparison.seeds) * (1 + driven) * costs.checkpoint_b,
    )


def speedup(work: Sequence[Work], machines: Machines) -> float:
    """Return how many times as fast as one core the machines are."""
    return sum(piece.cpu_s for piece in work) / wall_s(work, machines)


def print_estimate(costs: Costs, plan: LearningPlan, console: Console) -> None:
    """Print the time by cores and devices, what bounds it, and what travels."""
    work = work_of(costs, plan)
    table = Table(box=None, pad_edge=False)
    table.add_column("cores", justify="right")
    for devices in DEVICES:
        heading = "no device" if devices == 0 else f"{devices} device{'s' * (devices > 1)}"
        table.add_column(heading, justify="right")
    for cores in CORES:
        table.add_row(str(cores), *(_cell(work, Machines(cores, each)) for each in DEVICES))
    console.print(table)
    travels = moved(costs, plan)
    fits_s = sum(piece.cpu_s for piece in work if piece.kind == "fit")
    total_s = sum(piece.cpu_s for piece in work)
    console.print(
        f"{total_s / 3600:.2f} hours of one core like this one, {fits_s / total_s:.0%} of them "
        f"fits; the longest chain is {longest_chain_s(work) / 60:.1f} minutes. A device is taken "
        f"to fit {Machines(1).device_speedup:g} times as fast as a core."
    )
    console.print(
        f"On other machines {travels.episodes_b / 1e9:.2f} GB of episodes come back, and "
        f"{travels.checkpoints_b / 1e6:.0f} MB of checkpoints go to each."
    )


def _cell(work: Sequence[Work], machines: Machines) -> str:
    return f"{wall_s(work, machines) / 60:.1f} min ({speedup(work, machines):.1f}x)"


def _new(directory: Path) -> Path:
    """A directory in it that no trial has begun in: half a trial has no costs."""
    number = 1
    while (path := directory / f"trial-{number}").exists():
        number += 1
    path.mkdir()
    return path
