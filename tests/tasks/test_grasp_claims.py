"""The claims of the grasp in clutter find their numbers in a summary of an experiment's shape."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from sheath_manip.experiments.claims import verdicts
from sheath_manip.experiments.summary import summarise
from sheath_manip.metrics import EpisodeRecord
from sheath_manip.tasks.grasp_clutter.study.entry import STUDY
from sheath_manip.types import Outcome
from tests.experiments.round_results import round_result

# By method: per mille toppled under the gate, per cent that the last policy alone succeeds in,
# per cent that the expert acts in.
GOOD = {"dagger": (400, 80, 0), "sheath": (20, 90, 30), "cloning": (0, 95, 100)}


def records(toppled: float, succeeded: float, expert: int, count: int) -> tuple[EpisodeRecord, ...]:
    """Of so many episodes; those that neither topple nor succeed are stuck."""

    def outcome(share: float) -> Outcome:
        if share < toppled:
            return Outcome.FAILURE
        return Outcome.SUCCESS if share >= 1 - succeeded else Outcome.TIME_LIMIT

    return tuple(
        EpisodeRecord(0, outcome(index / count), {"success": 1.0}, 100, expert, 100, 0, 0)
        for index in range(count)
    )


def broken(directory: Path, plan: str = "full", **changed: tuple[float, float, int]) -> list[str]:
    settings = STUDY.plans[plan]
    results = {}
    for name, (toppled, alone, expert) in (GOOD | changed).items():
        results[name] = [
            replace(
                round_result(settings, "dagger", seed, number),
                executed=records(toppled / 1000, 1 - toppled / 1000, expert, 100),
                policy=records(0.0, alone / 100 if number else 0.5, 0, 100),
                final=records(0.0, alone / 100, 0, 100),
            )
            for seed in settings.comparison.seeds
            for number in range(settings.schedule.rounds + 1)
        ]
    place = "grasp-clutter" if plan == "full" else f"grasp-clutter-{plan}"
    summary = summarise(place, settings, results, records(0, 1, 100, 10), "sheath", 1.0)
    (directory / place).mkdir(parents=True)
    (directory / place / "summary.json").write_text(json.dumps(summary))
    claims = {"grasp-clutter": STUDY.claims}
    claims |= {f"grasp-clutter-{name}": own for name, own in STUDY.plan_claims.items()}
    found = verdicts(directory, claims)
    assert len(found) == len(claims[place])
    return [verdict.name for verdict in found if not verdict.holds]


@pytest.mark.parametrize("plan", ["full", "recipe"])
def test_they_hold_where_the_numbers_are_good(plan, tmp_path):
    assert broken(tmp_path, plan) == []


@pytest.mark.parametrize(
    ("plan", "changed", "claim"),
    [
        ("full", {"sheath": (40, 90, 30)}, "topple"),
        ("full", {"sheath": (20, 80, 30)}, "policy alone"),
        ("full", {"sheath": (20, 90, 40)}, "expert share"),
        ("full", {"dagger": (400, 50, 0)}, "gains"),
        ("recipe", {"cloning": (0, 92, 100)}, "recipe"),
    ],
)
def test_one_bad_number_breaks_its_claim(plan, changed, claim, tmp_path):
    (name,) = broken(tmp_path, plan, **changed)
    assert claim in name
