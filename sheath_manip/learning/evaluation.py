"""Whoever acts alone, on scenes that nobody has learned from."""

from collections.abc import Callable, Sequence
from functools import partial

from sheath_manip.gates import AlwaysExpert, AlwaysPolicy, redrawing
from sheath_manip.learning.checkpoint import Checkpoint
from sheath_manip.metrics import EpisodeRecord, record_of
from sheath_manip.protocols import Environment, Expert, Gate, Policy, Report
from sheath_manip.rollout.loop import rollout
from sheath_manip.seeding import generator
from sheath_manip.types import EpisodeInfo, Purpose


def evaluate_policy(
    environment: Environment,
    variant: str,
    checkpoint: Checkpoint,
    seeds: Sequence[int],
    report: Report = lambda _: None,
) -> list[EpisodeRecord]:
    """The policy alone on the scenes of `seeds`; nothing is recorded, nothing learned from it.

    `environment` is one of that `variant`.
    """
    policy, method = checkpoint.policy, checkpoint.method
    gate = partial(redrawing, AlwaysPolicy(), policy)
    number = checkpoint.round
    return _judged(environment, variant, seeds, gate, report, method, number, policy=policy)


def evaluate_expert(
    environment: Environment,
    variant: str,
    expert: Expert,
    name: str,
    seeds: Sequence[int],
    report: Report = lambda _: None,
) -> list[EpisodeRecord]:
    """Likewise an expert, or who sits in its place."""
    return _judged(environment, variant, seeds, AlwaysExpert, report, name, expert=expert)


def _judged(
    environment: Environment,
    variant: str,
    seeds: Sequence[int],
    gate: Callable[[], Gate],
    report: Report,
    name: str,
    number: int = 0,
    *,
    policy: Policy | None = None,
    expert: Expert | None = None,
) -> list[EpisodeRecord]:
    records = []
    for index, seed in enumerate(seeds):
        info = EpisodeInfo.of(
            environment.spec,
            variant=variant,
            seed=seed,
            purpose=Purpose.EVALUATION,
            method=name,
            round=number,
            index=index,
        )
        rng = generator("alone", seed)
        episode = rollout(environment, info, gate(), rng=rng, policy=policy, expert=expert)
        records.append(record_of(episode))
        report(f"{name} alone")
    return records
