"""A gate in the loop: what fails under it, what the expert must do, what is learned from it."""

import dataclasses
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sheath_manip.exceptions import StoreError
from sheath_manip.experiments.gates.rows import BASELINES
from sheath_manip.experiments.gates.setting import Setting
from sheath_manip.files.json_files import write_json
from sheath_manip.learning.checkpoint import load_checkpoint
from sheath_manip.learning.drivers import GivenPolicy
from sheath_manip.learning.evaluation import evaluation_requests
from sheath_manip.metrics import EpisodeRecord, expert_share, record_of
from sheath_manip.protocols import Environment, Report
from sheath_manip.rollout.executor import Executor
from sheath_manip.rollout.request import Crew, EpisodeRequest
from sheath_manip.rollout.serial import SerialExecutor
from sheath_manip.seeding import scene_seed
from sheath_manip.task import Task
from sheath_manip.types import Episode, EpisodeInfo, Outcome, Purpose, TaskSpec
from sheath_manip.types.samples import joined, samples_from


@dataclass(frozen=True)
class Loop:
    """What happened under one gate; the cloned policy drove in all of it."""

    points: tuple[tuple[EpisodeRecord, ...], ...]
    """one a threshold, in the order of the plan's `rates`"""
    learned_from: int
    """the point with the expert share nearest to the plan's"""
    final: tuple[EpisodeRecord, ...]
    """the policy that learned from that point, alone on held-out scenes; empty where none did"""


@dataclass(frozen=True)
class Size:
    """How much of the loop a row gets."""

    episodes: int
    """for each threshold"""
    held_out: int
    """scenes on which the policy is judged that learned from it; with 0 none learns"""


def write_loop(path: Path, loop: Loop) -> None:
    """Write atomically."""
    write_json(path, dataclasses.asdict(loop))


def read_loop(path: Path) -> Loop:
    """Raises StoreError for a file that is missing or no result."""
    try:
        content = json.loads(path.read_text())
        return Loop(
            tuple(_records(point) for point in content["points"]),
            int(content["learned_from"]),
            _records(content["final"]),
        )
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise StoreError(
            f"{path} is no result of a gate in the loop ({error}); remove it to have it run again"
        ) from error


@dataclass(frozen=True)
class GateOfRow:
    """The policy that all gates watch over, under a row's gate at one of the plan's rates."""

    setting: Setting
    row: str
    number: int
    """of the rate"""

    def crew(self, task: Task, environment: Environment) -> Crew:
        """Read the row's checkpoint, and set its threshold."""
        at, spec = self.setting, environment.spec
        rates, expert = at.plan.rates, task.expert(environment)
        if self.row in BASELINES:
            gate = BASELINES[self.row](rates)[self.number]
            return Crew(gate, at.cloned(spec).policy, expert)
        checkpoint = load_checkpoint(at.checkpoint_path(self.row), spec)
        thresholds = json.loads(at.offline_path(self.row).read_text())["thresholds"]
        judging = checkpoint.with_threshold(thresholds[str(rates[self.number])])
        return Crew(judging.gate(), checkpoint.policy, expert)


def run_loop(setting: Setting, row: str, size: Size, report: Report) -> Loop:
    """Drive under the gate of `row` at each threshold, learn from one of them, and judge that."""
    rates = setting.plan.rates
    gates = len(BASELINES[row](rates) if row in BASELINES else rates)
    with SerialExecutor() as executor:
        runs = [
            list(executor.map(_requests(setting, row, number, size), report=report))
            for number in range(gates)
        ]
        points = tuple(tuple(record_of(episode) for episode in run) for run in runs)
        nearest = min(
            range(len(points)),
            key=lambda number: abs(expert_share(points[number]) - setting.plan.share),
        )
        final = _learned(setting, row, runs[nearest], size.held_out, executor, report)
        return Loop(points, nearest, final)


def _requests(setting: Setting, row: str, number: int, size: Size) -> list[EpisodeRequest]:
    """Episodes on the scenes that all gates and thresholds meet."""
    spec, driver = _spec(setting), GateOfRow(setting, row, number)
    variant = setting.learning.schedule.variant
    infos = [
        EpisodeInfo.of(
            spec,
            variant=variant,
            seed=scene_seed(Purpose.LEARNING, "gates", setting.seed, index),
            purpose=Purpose.LEARNING,
            method=row,
            round=number,
            index=index,
            run_seed=setting.seed,
        )
        for index in range(size.episodes)
    ]
    return [EpisodeRequest(setting.task, info, driver) for info in infos]


def _learned(
    setting: Setting,
    row: str,
    episodes: Sequence[Episode],
    held_out: int,
    executor: Executor,
    report: Report,
) -> tuple[EpisodeRecord, ...]:
    """What the policy does alone once it has also learned from `episodes`."""
    if held_out == 0:
        return ()
    spec = _spec(setting)
    learner = setting.cloned(spec).policy
    learner.fit(joined([setting.demonstrations(), samples_from(episodes)]))
    learning = setting.learning
    requests = evaluation_requests(
        setting.task,
        learning.schedule.variant,
        spec,
        GivenPolicy(learner),
        learning.comparison.held_out_set,
        held_out,
        method=row,
        run_seed=setting.seed,
    )
    return tuple(record_of(episode) for episode in executor.map(requests, report=report))


def _spec(setting: Setting) -> TaskSpec:
    environment = setting.environment()
    environment.close()
    return environment.spec


def _records(content: Sequence[Mapping[str, Any]]) -> tuple[EpisodeRecord, ...]:
    return tuple(
        EpisodeRecord(**{**record, "outcome": Outcome(record["outcome"])}) for record in content
    )
