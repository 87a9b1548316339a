"""A policy alone on scenes that it has not learned from."""

from collections.abc import Callable, Sequence

from sheath_manip.checkpoint import Checkpoint
from sheath_manip.gates import AlwaysPolicy, redrawing
from sheath_manip.metrics import EpisodeRecord, record_of
from sheath_manip.protocols import Environment
from sheath_manip.rollout import rollout
from sheath_manip.seeding import generator
from sheath_manip.types import EpisodeInfo, Purpose

Report = Callable[[str], None]
"""called once for each unit of work done (`LearningPlan.units`), with a word on what it was"""


def evaluate_policy(
    environment: Environment,
    checkpoint: Checkpoint,
    seeds: Sequence[int],
    report: Report = lambda _: None,
) -> list[EpisodeRecord]:
    """The policy alone on the scenes of `seeds`; nothing is recorded, nothing learned from it."""
    records = []
    for index, seed in enumerate(seeds):
        info = EpisodeInfo(
            task=checkpoint.task,
            seed=seed,
            purpose=Purpose.EVALUATION,
            control_rate_hz=environment.spec.control_rate_hz,
            method=checkpoint.method,
            round=checkpoint.round,
            index=index,
        )
        episode = rollout(
            environment,
            info,
            redrawing(AlwaysPolicy(), checkpoint.policy),
            rng=generator("alone", seed),
            policy=checkpoint.policy,
        )
        records.append(record_of(episode))
        report(f"{checkpoint.method} alone")
    return records
