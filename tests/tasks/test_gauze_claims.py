"""The claims of gauze cutting find their numbers in a summary of an experiment's shape."""

import json
from dataclasses import asdict, replace
from pathlib import Path

import pytest

from sheath_manip.experiments.claims import verdicts
from sheath_manip.experiments.summary import summarise
from sheath_manip.files.json_files import plain
from sheath_manip.metrics import EpisodeRecord, figures_of
from sheath_manip.tasks.gauze_cutting.study.entry import STUDY
from sheath_manip.types import Outcome
from tests.experiments.round_results import round_result

SETTINGS = STUDY.plans["full"]
# By method: per mille ruined under the gate, per cent that the last policy frees alone, their IoU.
GOOD = {
    "cloning": (0, 60, 0.9),
    "dagger": (300, 85, 0.96),
    "sheath": (20, 90, 0.97),
    "sheath-own-labels": (20, 90, 0.97),
    "random-blocks": (200, 80, 0.96),
}


def records(ruined: float, freed: float, iou: float) -> tuple[EpisodeRecord, ...]:
    """Of 100 episodes; those that neither ruin the sheet nor free the disc run out of time."""

    def record(share: float) -> EpisodeRecord:
        done = share >= 1 - freed
        outcome = Outcome.FAILURE if share < ruined else Outcome.TIME_LIMIT
        metrics = {"iou": iou * done, "freed": float(done)}
        return EpisodeRecord(0, Outcome.SUCCESS if done else outcome, metrics, 160, 40, 40, 2, 1)

    return tuple(record(index / 100) for index in range(100))


def broken(directory: Path, wall_s: float = 3600.0, **changed: tuple[float, float, float]):
    results = {}
    for name, (ruined, alone, iou) in (GOOD | changed).items():
        results[name] = [
            replace(
                round_result(SETTINGS, "dagger", seed, number),
                executed=records(ruined / 1000, 1 - ruined / 1000, 0.98),
                policy=records(0.0, alone / 100, iou),
                final=records(0.0, alone / 100, iou),
            )
            for seed in SETTINGS.comparison.seeds
            for number in range(SETTINGS.schedule.rounds + 1)
        ]
    expert = records(0.0, 1.0, 0.99)
    registered = plain(asdict(figures_of(records(0.0, 0.17, 0.94))))
    summary = summarise(
        "gauze-cutting",
        SETTINGS,
        results,
        expert,
        "sheath",
        wall_s,
        references={"registered": registered},
    )
    (directory / "gauze-cutting").mkdir(parents=True)
    (directory / "gauze-cutting" / "summary.json").write_text(json.dumps(summary))
    found = verdicts(directory, {"gauze-cutting": STUDY.claims})
    assert len(found) == len(STUDY.claims)
    return [verdict.name for verdict in found if not verdict.holds]


def test_good_results_break_no_claim(tmp_path):
    assert broken(tmp_path) == []


@pytest.mark.parametrize(
    ("method", "figures", "names"),
    [
        ("sheath", (50, 90, 0.97), ["sheets that SHEATH ruins"]),
        ("dagger", (10, 85, 0.96), ["sheets that SHEATH ruins, those of DAgger"]),
        (
            "random-blocks",
            (20, 80, 0.96),
            ["sheets that SHEATH ruins, those of takeovers at random"],
        ),
        ("sheath", (20, 70, 0.97), ["discs that SHEATH's final policy frees alone"]),
        ("sheath", (20, 90, 0.94), ["IoU of those discs"]),
        (
            "sheath",
            (20, 0, 0.0),
            [
                "discs that SHEATH's final policy frees alone",
                "discs that SHEATH's final policy frees alone, those of the registered open loop",
                "IoU of those discs",
            ],
        ),
    ],
)
def test_a_bad_figure_breaks_its_own_claim(tmp_path, method, figures, names):
    assert broken(tmp_path, **{method: figures}) == names


def test_too_long_a_run_is_said(tmp_path):
    assert broken(tmp_path, wall_s=7000.0) == ["wall time, minutes"]
