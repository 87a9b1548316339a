"""A gate in the loop: what fails under it, what the expert must do, what is learned from it."""

import dataclasses
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from sheath_manip.exceptions import StoreError
from sheath_manip.experiments.gates.rows import BASELINES
from sheath_manip.experiments.gates.setting import Setting
from sheath_manip.gates import SupportGate
from sheath_manip.json_files import write_json
from sheath_manip.learning.checkpoint import Checkpoint, load_checkpoint
from sheath_manip.learning.evaluation import evaluate_policy
from sheath_manip.metrics import EpisodeRecord, expert_share, record_of
from sheath_manip.protocols import Environment, Gate, Policy, Report
from sheath_manip.rollout.loop import rollout
from sheath_manip.seeding import generator, scene_seed
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


def run_loop(setting: Setting, row: str, size: Size, report: Report) -> Loop:
    """Drive under the gate of `row` at each threshold, learn from one of them, and judge that."""
    environment = setting.environment()
    try:
        checkpoint, gates = _gates(setting, row, environment.spec)
        runs = [
            [
                _driven(setting, row, number, index, gate, checkpoint.policy, environment, report)
                for index in range(size.episodes)
            ]
            for number, gate in enumerate(gates)
        ]
        points = tuple(tuple(record_of(episode) for episode in run) for run in runs)
        nearest = min(
            range(len(points)),
            key=lambda number: abs(expert_share(points[number]) - setting.plan.share),
        )
        final = _learned(setting, row, runs[nearest], size.held_out, environment, report)
        return Loop(points, nearest, final)
    finally:
        environment.close()


def _gates(setting: Setting, row: str, spec: TaskSpec) -> tuple[Checkpoint, Sequence[Gate]]:
    """The checkpoint whose policy drives, and one gate a threshold."""
    if row in BASELINES:
        return setting.cloned(spec), BASELINES[row](setting.plan.rates)
    checkpoint = load_checkpoint(setting.checkpoint_path(row), spec)
    thresholds = json.loads(setting.offline_path(row).read_text())["thresholds"]
    return checkpoint, [
        SupportGate(checkpoint.score, thresholds[str(rate)]) for rate in setting.plan.rates
    ]


def _driven(
    setting: Setting,
    row: str,
    number: int,
    index: int,
    gate: Gate,
    policy: Policy,
    environment: Environment,
    report: Report,
) -> Episode:
    """One episode on a scene that all gates and thresholds meet."""
    info = EpisodeInfo.of(
        environment.spec,
        variant=setting.learning.variant,
        seed=scene_seed(Purpose.LEARNING, "gates", setting.seed, index),
        purpose=Purpose.LEARNING,
        method=row,
        round=number,
        index=index,
        run_seed=setting.seed,
    )
    episode = rollout(
        environment,
        info,
        gate,
        rng=generator("gate", row, setting.seed, number, index),
        policy=policy,
        expert=setting.task.expert(environment),
    )
    report(f"loop {row}")
    return episode


def _learned(
    setting: Setting,
    row: str,
    episodes: Sequence[Episode],
    held_out: int,
    environment: Environment,
    report: Report,
) -> tuple[EpisodeRecord, ...]:
    """What the policy does alone once it has also learned from `episodes`."""
    if held_out == 0:
        return ()
    learner = setting.cloned(environment.spec)
    learner.policy.fit(joined([setting.demonstrations(), samples_from(episodes)]))
    seeds = setting.evaluation_seeds(held_out)
    learned = replace(learner, method=row)
    return tuple(evaluate_policy(environment, setting.learning.variant, learned, seeds, report))


def _records(content: Sequence[Mapping[str, Any]]) -> tuple[EpisodeRecord, ...]:
    return tuple(
        EpisodeRecord(**{**record, "outcome": Outcome(record["outcome"])}) for record in content
    )
