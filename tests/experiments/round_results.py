"""Rounds of learning as an experiment might give them, without running one."""

import numpy as np

from sheath_manip.learning.config import LearningPlan
from sheath_manip.learning.results import RoundResult
from sheath_manip.learning.theory import Bound
from sheath_manip.metrics import EpisodeRecord
from sheath_manip.types import Outcome

STEPS = 140
# By method: share of executed episodes that fail in round 1, the expert's share in round 1.
TRAITS = {
    "cloning": (0.01, 1.0),
    "dagger": (0.45, 0.0),
    "sheath": (0.08, 0.35),
    "sheath-own-labels": (0.12, 0.35),
    "random-blocks": (0.33, 0.35),
    "random-takeover": (0.33, 0.35),
    "hg-dagger": (0.15, 0.2),
}


def record(
    rng: np.random.Generator, failure: float, share: float, laps: float = 1.0
) -> EpisodeRecord:
    failed = rng.random() < failure
    driven = laps * rng.uniform(0.05, 0.95) if failed else laps
    steps = max(int(STEPS * driven), 1)
    acted = round(share * steps)
    switches = int(rng.poisson(12 * 4 * share * (1 - share)))
    return EpisodeRecord(
        seed=int(rng.integers(1000)),
        outcome=Outcome.FAILURE if failed else Outcome.SUCCESS,
        metrics={"laps": driven},
        steps=steps,
        expert_steps=acted,
        queries=steps,
        switches=switches,
        interventions=switches // 2,
        control_rate_hz=10.0,
        turns=(acted // max(switches // 2, 1),) * (switches // 2),
    )


def records(
    rng: np.random.Generator, count: int, failure: float, share: float, laps: float = 1.0
) -> tuple[EpisodeRecord, ...]:
    return tuple(record(rng, failure, share, laps) for _ in range(count))


def round_result(plan: LearningPlan, method: str, run_seed: int, number: int) -> RoundResult:
    """What gets better with the rounds gets better here; round 0 is the same for all methods."""
    known = method if number else "expert"
    rng = np.random.default_rng([run_seed, number, sum(known.encode())])
    failure, share = TRAITS[method] if number else (0.0, 1.0)
    progress = 1 / max(number, 1)
    if 0 < share < 1:
        share *= 0.15 + 0.85 * progress
    alone = 0.35 if method == "cloning" else 0.06
    alone = alone + (0.5 - alone) / (1 + number)
    last = number == plan.schedule.rounds
    executed = failure * (0.2 + 0.8 * progress) if method != "cloning" else failure
    return RoundResult(
        method=known,
        run_seed=run_seed,
        round=number,
        checkpoint="0" * 16,
        executed=records(rng, plan.schedule.episodes, executed, share),
        policy=records(rng, plan.comparison.evaluation_episodes, alone, 0.0),
        final=records(rng, plan.comparison.final_episodes, 1.6 * alone, 0.0, laps=3.0)
        if last
        else (),
        false_alarm_rate=0.05 + 0.02 * rng.standard_normal(),
        missed_rate=(1 - share) * 0.7,
        surrogate_loss=0.05 + 0.12 * progress,
        bound=Bound(
            STEPS, 0.06 + 0.01 * number, 0.05 + 0.4 * progress, STEPS * (0.05 + 0.12 * progress)
        ),
        threshold=-0.01,
        states=STEPS * plan.schedule.episodes * (number + 1),
        wall_s=20.0,
    )


def results_of(plan: LearningPlan) -> dict[str, list[RoundResult]]:
    """All rounds of all methods and seeds."""
    return {
        method: [
            round_result(plan, method, seed, number)
            for seed in plan.comparison.seeds
            for number in range(plan.schedule.rounds + 1)
        ]
        for method in plan.comparison.methods
    }


def expert_records_of(plan: LearningPlan) -> list[EpisodeRecord]:
    schedule = plan.schedule
    held_out = schedule.calibration + schedule.false_alarm_episodes
    count = len(plan.comparison.seeds) * (schedule.demonstrations + held_out)
    return list(records(np.random.default_rng(0), count, 0.01, 1.0))
