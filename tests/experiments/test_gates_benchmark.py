"""The whole benchmark of gates, small, on the toy task."""

import io
import json
import shutil
from dataclasses import replace
from pathlib import Path

import pytest
from rich.console import Console

from sheath_manip.exceptions import ParameterError, UnknownNameError
from sheath_manip.experiments.gates.benchmark import run_gates
from sheath_manip.experiments.gates.figures import highlighted
from sheath_manip.experiments.gates.plan import PLANS, GatesPlan
from sheath_manip.experiments.gates.rows import BASELINES, default_name, rows
from sheath_manip.experiments.gates.summary import pooled
from sheath_manip.experiments.gates.table import tables
from sheath_manip.policies import EMBEDDINGS, FEATURE_EMBEDDINGS, IMAGE_EMBEDDINGS
from sheath_manip.rollout.executing import Executing
from sheath_manip.support import SUPPORTS
from tests.experiments.test_figures_generic import assert_shows_something
from tests.toy import PLAN
from tests.toy import STUDY as TOY

SMALL = GatesPlan(
    embeddings=("pixels",),
    supports=("one-class-svm", "mahalanobis"),
    displaced_every=4,
    displaced_episodes=2,
    visited=3,
    window=3,
    spared=5,
    few_false_alarm_rate=0.1,
    rates=(0.1, 0.3),
    episodes=2,
    held_out=1,
)
STUDY = replace(
    TOY,
    plans={
        "full": PLAN.changed(
            policy={"name": "hog-svm"},
            gate={"embedding": "pixels", "precedent_embedding": "pixels"},
            schedule={"demonstrations": 2, "calibration": 6, "false_alarm_episodes": 2},
        )
    },
)


def benchmark(directory: Path, workers: int = 0, plan: GatesPlan = SMALL) -> dict:
    return run_gates(
        [STUDY],
        plan,
        runs=directory / "runs",
        results=directory / "results",
        command="sheath experiment gates",
        executing=Executing(workers=workers),
        console=Console(file=io.StringIO()),
    )


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> Path:
    directory = tmp_path_factory.mktemp("gates")
    benchmark(directory)
    return directory


def summary_of(directory: Path) -> dict:
    """Without what depends on the time of day: others may commit while this runs."""
    summary = json.loads((directory / "results" / "summary.json").read_text())
    return summary | {"wall_s": None, "git": None}


def test_every_gate_and_every_baseline_is_a_row(whole):
    found = summary_of(whole)["tasks"]["corridor"]
    assert found["default"] == "joined"
    assert set(found["rows"]) == {
        "joined",
        "precedent",
        "pixels/one-class-svm",
        "pixels/mahalanobis",
        *BASELINES,
    }
    row = found["rows"]["pixels/one-class-svm"]
    assert set(row["auroc"]) == set(row["far_outside"]) == {"aside 0.4 m", "aside 0.9 m"}
    assert row["auroc"]["aside 0.9 m"] > 0.9
    assert row["auroc_far"] == row["auroc"]["aside 0.9 m"]
    assert row["few"]["expert_inside"] >= row["expert_inside"] - 0.2
    assert set(row["alarm"]["at"]) == {"step", "window", "episode"}
    assert row["errs"]["differing_states"]["count"] >= 3


def test_in_the_loop_all_meet_the_same_scenes_and_are_compared_at_one_share(whole):
    found = summary_of(whole)["tasks"]["corridor"]["rows"]
    loops = {
        path.stem: json.loads(path.read_text())
        for path in (whole / "runs").glob("*/s0/loop/**/*.json")
    }
    scenes = {
        tuple(record["seed"] for record in point)
        for loop in loops.values()
        for point in loop["points"]
    }
    assert len(scenes) == 1
    assert [len(loop["points"]) for loop in loops.values()].count(2) == 5
    assert found["policy"]["loop"]["points"][0]["expert_share"] == 0
    assert found["expert"]["loop"]["points"][0]["expert_share"] == 1
    assert found["expert"]["loop"]["at_share"] is None
    at = found["random-takeover"]["loop"]["at_share"]
    assert at["expert_share"] == SMALL.share
    assert at["ci95"][0] <= at["failure_rate"] <= at["ci95"][1]
    for row in found.values():
        assert row["loop"]["final"]["episodes"] == 1


def test_the_figures_show_something(whole):
    assert summary_of(whole)["talk"] == "corridor-noticed.png"
    for kind in ("noticed", "share"):
        assert_shows_something(whole / "results" / f"corridor-{kind}.png")


def test_the_tables_fit_100_columns(whole, capsys):
    Console(width=100).print(tables(summary_of(whole)))
    shown = capsys.readouterr().out
    assert "…" not in shown
    assert max(map(len, shown.splitlines())) <= 100
    for word in ("pixels", "mahalanobis", "random-takeover", "costly"):
        assert word in shown


def test_resumed_it_gives_the_same_summary(whole, tmp_path):
    directory = tmp_path / "again"
    shutil.copytree(whole, directory)
    seed = directory / "runs" / "corridor" / "s0"
    # As if it had been killed between two gates.
    (seed / "offline" / "pixels" / "mahalanobis.json").unlink()
    shutil.rmtree(seed / "loop" / "pixels")
    (seed / "loop" / "policy.json").unlink()
    kept = (seed / "loop" / "expert.json").stat().st_mtime_ns
    benchmark(directory)
    assert summary_of(directory) == summary_of(whole)
    assert (seed / "loop" / "expert.json").stat().st_mtime_ns == kept


def test_another_plan_does_not_resume_it_but_other_rows_join(whole, tmp_path):
    shutil.copytree(whole, tmp_path / "run")
    with pytest.raises(ParameterError, match="another rates;"):
        benchmark(tmp_path / "run", plan=replace(SMALL, rates=(0.2,)))
    joined = replace(SMALL, supports=(*(SMALL.supports or ()), "neighbors"))
    found = benchmark(tmp_path / "run", plan=joined)["tasks"]["corridor"]["rows"]
    before = summary_of(whole)["tasks"]["corridor"]["rows"]
    assert found["pixels/mahalanobis"] == before["pixels/mahalanobis"]
    assert "pixels/neighbors" in found


@pytest.mark.soak
# Of so few episodes one signal's threshold lies next to what is infinitely far, on some processors.
@pytest.mark.filterwarnings("ignore::sheath_manip.exceptions.GateWarning")
def test_the_rest_of_the_grid_may_stay_out_of_the_loop(tmp_path, capsys):
    plan = replace(SMALL, embeddings=("pixels", "pixels-whitened"), other_episodes=0, held_out=0)
    found = benchmark(tmp_path, plan=plan)["tasks"]["corridor"]["rows"]
    outside = [name for name, row in found.items() if row["loop"] is None]
    assert outside == ["pixels-whitened/mahalanobis"]
    assert found[outside[0]]["auroc_far"] > 0.5
    Console(width=100).print(tables(summary_of(tmp_path)))
    assert "pixels-whitened" in capsys.readouterr().out
    assert_shows_something(tmp_path / "results" / "corridor-share.png")


def test_a_plan_may_name_its_tasks(tmp_path):
    with pytest.raises(UnknownNameError, match="task with probes 'maze'; known: corridor"):
        benchmark(tmp_path, plan=replace(SMALL, tasks=("maze",)))


@pytest.mark.soak
def test_two_processes_give_the_numbers_of_one(whole, tmp_path):
    benchmark(tmp_path, workers=2)
    assert summary_of(tmp_path) == summary_of(whole)


def test_the_rows_are_the_product_of_the_tables_the_default_first():
    learning = STUDY.plans["full"]
    listed = rows(GatesPlan(), learning)
    assert len(listed) >= len(IMAGE_EMBEDDINGS) * len(SUPPORTS)
    assert listed[0].name == default_name(listed, learning)
    assert len({row.name for row in listed}) == len(listed)
    mains = [row.main for row in listed]
    assert mains == sorted(mains, reverse=True)


def test_on_a_task_without_images_embeddings_of_features_are_compared():
    learning = STUDY.plans["full"].changed(
        gate={"embedding": "features", "precedent_embedding": "features"}
    )
    compared = {row.plan.gate.embedding for row in rows(GatesPlan(), learning)}
    assert compared == set(FEATURE_EMBEDDINGS)


def test_unknown_names_and_tasks_without_probes_are_one_line(tmp_path):
    with pytest.raises(UnknownNameError, match=r"'magic'; known: .*pixels"):
        GatesPlan(embeddings=("magic",))
    with pytest.raises(ParameterError, match="no task has probes"):
        run_gates(
            [replace(STUDY, probes=None)],
            SMALL,
            runs=tmp_path,
            results=tmp_path,
            command="",
            executing=Executing(workers=0),
        )


def test_quick_is_a_part_of_full():
    quick = PLANS["quick"]
    assert set(quick.embeddings or ()) <= set(EMBEDDINGS)
    assert set(quick.supports or ()) <= set(SUPPORTS)


def test_seeds_are_pooled_by_counts():
    rate = {"hits": 1, "count": 2, "value": 0.5, "ci95": [0.1, 0.9]}
    both = pooled(
        [{"a": rate, "b": 1.0, "c": [None]}, {"a": {**rate, "count": 6}, "b": 2.0, "c": [4]}]
    )
    assert (both["a"]["hits"], both["a"]["value"]) == (2, 0.25)
    assert (both["b"], both["c"]) == (1.5, [4.0])


def test_few_gates_are_told_apart_in_the_figures():
    def row(costly: float, *signals: str) -> dict:
        return {"errs": {"costly": costly}, "signals": signals}

    found = {
        "default": "a",
        "rows": {
            "a": row(0.7, "s"),
            "b": row(0.8, "s"),
            "c": row(0.2, "s"),
            "d": row(0.5, "s", "t"),
        },
    }
    # With random takeover four.
    assert highlighted(found) == {"a": "default", "b": "best other", "c": "worst"}


def test_the_default_is_a_row_whatever_else_is_asked_for():
    learning = STUDY.plans["full"]
    listed = rows(GatesPlan(embeddings=("penultimate",), supports=()), learning)
    names = ["joined", "precedent", "pixels/one-class-svm", "penultimate/one-class-svm"]
    assert [row.name for row in listed] == names
    assert default_name(listed, learning) == listed[0].name
