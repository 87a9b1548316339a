"""The platformer's claims find their numbers in a summary of an experiment's shape."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from sheath_manip.experiments.claims import verdicts
from sheath_manip.experiments.summary import summarise
from sheath_manip.learning.results import RoundResult
from sheath_manip.metrics import EpisodeRecord
from sheath_manip.tasks.platformer.study.entry import STUDY
from sheath_manip.types import Outcome
from tests.experiments.round_results import round_result

PLAN = STUDY.plans["full"].changed(
    comparison={"methods": ("dagger", "sheath", "sheath-own-labels")}
)
# By method: tiles under the gate, tiles of the policy alone, labels an episode.
GOOD = {"dagger": (90, 150, 400), "sheath": (205, 160, 400), "sheath-own-labels": (205, 155, 110)}


def record(tiles: float, queries: int = 0) -> EpisodeRecord:
    metrics = {"distance_tiles": tiles, "progress": tiles / 220, "stomped": 1.0}
    return EpisodeRecord(0, Outcome.SUCCESS, metrics, 400, queries, queries, 0, 0)


def results_of(traits: dict[str, tuple[float, float, int]]) -> dict[str, list[RoundResult]]:
    """Policies get better by a tile a round up to what is said of them."""
    return {
        method: [
            replace(
                round_result(PLAN, "dagger", seed, number),
                executed=(record(executed, queries),),
                policy=(record(alone - (PLAN.schedule.rounds - number)),),
                final=(),
            )
            for seed in PLAN.comparison.seeds
            for number in range(PLAN.schedule.rounds + 1)
        ]
        for method, (executed, alone, queries) in traits.items()
    }


def broken(directory: Path, **changed: tuple[float, float, int]) -> list[str]:
    traits = GOOD | {name.replace("_", "-"): value for name, value in changed.items()}
    summary = summarise("platformer", PLAN, results_of(traits), [record(219)], "sheath", 1.0)
    (directory / "platformer").mkdir(parents=True)
    (directory / "platformer" / "summary.json").write_text(json.dumps(summary))
    found = verdicts(directory, {"platformer": STUDY.claims})
    assert len(found) == len(STUDY.claims)
    return [verdict.name for verdict in found if not verdict.holds]


def test_they_hold_where_the_numbers_are_good(tmp_path):
    assert broken(tmp_path) == []


@pytest.mark.parametrize(
    ("changed", "claims"),
    [
        # DAgger's policy ends up farther than SHEATH's robot ever came under its gate.
        ({"dagger": (90, 210, 400)}, 3),
        # SHEATH's robot comes as far as DAgger's policy, but not near the expert.
        ({"sheath": (180, 160, 400)}, 1),
        ({"sheath": (205, 140, 400)}, 1),
        ({"sheath_own_labels": (205, 155, 130)}, 1),
        ({"sheath_own_labels": (205, 140, 110)}, 1),
    ],
)
def test_one_bad_number_breaks_its_claim(changed, claims, tmp_path):
    assert len(broken(tmp_path, **changed)) == claims


def test_daggers_level_is_that_of_its_last_three_rounds(tmp_path):
    # Its policy alone comes 199, 200 and 201 tiles far in them.
    changed = {"dagger": (90, 201, 400), "sheath_own_labels": (205, 202, 110)}
    assert broken(tmp_path / "a", **changed, sheath=(200.1, 202, 400)) == []
    assert len(broken(tmp_path / "b", **changed, sheath=(199.9, 202, 400))) == 1
