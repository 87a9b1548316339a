import json
import math
import subprocess
from dataclasses import fields, replace

import numpy as np
import pytest
from rich.console import Console

from sheath_manip.burden import Burden
from sheath_manip.experiments.summary import git_revision, summarise
from sheath_manip.experiments.table import seeds_shown, table, with_interval
from sheath_manip.files.json_files import write_json
from sheath_manip.learning.config import LearningPlan
from sheath_manip.metrics import bounded_interval
from tests.experiments.round_results import expert_records_of, results_of

PLAN = LearningPlan().changed(
    comparison={"seeds": (0, 1), "evaluation_episodes": 6, "final_episodes": 4},
    schedule={"rounds": 3, "episodes": 5},
)
BURDENS = {each.name for each in fields(Burden)}
ROUND_KEYS = {
    "round", "runs", "executed", "policy", "expert_share", "queries", *BURDENS,
    "false_alarm_rate", "missed_rate", "surrogate_loss", "horizon", "epsilon", "xi", "bound",
    "measured", "threshold", "states",
}  # fmt: skip
RATES = {"failure_rate", "success_rate", "stuck_rate"}
FIGURE_KEYS = {"episodes", *RATES, "metric", "ci95"}


@pytest.fixture
def results():
    return results_of(PLAN)


@pytest.fixture
def summary(results) -> dict:
    return summarise(
        "driving", PLAN, results, expert_records_of(PLAN), "sheath experiment driving", 12.34
    )


def test_the_summary_has_the_one_shape_of_all_experiments(summary):
    assert {"experiment", "command", "git", "seeds", "wall_s", "expert", "methods"} <= set(summary)
    assert summary["seeds"] == [0, 1]
    assert summary["wall_s"] == 12.3
    assert summary["metric"] == "laps"
    assert summary["plan"]["schedule"]["rounds"] == 3
    assert set(summary["expert"]) == FIGURE_KEYS
    assert set(summary["methods"]) == set(PLAN.comparison.methods)
    for method in summary["methods"].values():
        assert [entry["round"] for entry in method["rounds"]] == [0, 1, 2, 3]
        for entry in method["rounds"]:
            assert set(entry) == ROUND_KEYS
            assert set(entry["executed"]) == set(entry["policy"]) == FIGURE_KEYS
            assert set(entry["executed"]["ci95"]) == {*RATES, "laps"}


def test_seeds_are_pooled_and_the_start_is_shared(summary, results):
    first = [method["rounds"][0] for method in summary["methods"].values()]
    assert all(entry == first[0] for entry in first)
    sheath = summary["methods"]["sheath"]
    assert [entry["executed"]["episodes"] for entry in sheath["rounds"]] == [10, 10, 10, 10]
    assert sheath["rounds"][2]["policy"]["episodes"] == 12
    second = [result for result in results["sheath"] if result.round == 2]
    assert sheath["rounds"][2]["bound"] == pytest.approx(
        sum(result.bound.value for result in second) / 2
    )
    asked = sum(record.queries for result in second for record in result.executed)
    assert sheath["rounds"][2]["queries"] == asked / 2


def test_overall_leaves_the_demonstrations_out(summary, results):
    learned = [result for result in results["sheath"] if result.round > 0]
    overall = summary["methods"]["sheath"]["overall"]
    assert overall["episodes"] == 30
    records = [record for result in learned for record in result.executed]
    share = sum(r.expert_steps for r in records) / sum(r.steps for r in records)
    assert overall["expert_share"] == pytest.approx(share)
    assert overall["queries"] == sum(record.queries for record in records) / 2
    assert summary["methods"]["sheath"]["final"]["episodes"] == 8


def test_areas_are_over_rounds_and_compared_run_by_run(summary, results):
    def of_run(method: str, seed: int) -> float:
        rounds = [r for r in results[method] if r.run_seed == seed and r.round > 0]
        return float(
            np.mean([np.mean([e.metrics["laps"] for e in each.policy]) for each in rounds])
        )

    area = summary["methods"]["sheath"]["area"]["policy"]
    assert area["runs"] == 2
    assert area["mean"] == pytest.approx(np.mean([of_run("sheath", seed) for seed in (0, 1)]))
    differences = [of_run("sheath", seed) - of_run("dagger", seed) for seed in (0, 1)]
    assert area["minus_dagger"]["mean"] == pytest.approx(np.mean(differences))
    low, high = area["minus_dagger"]["ci95"]
    assert low < np.mean(differences) < high
    assert summary["methods"]["dagger"]["area"]["policy"]["minus_dagger"]["ci95"] == [0.0, 0.0]


def test_without_dagger_an_area_has_nothing_to_be_compared_to(results):
    del results["dagger"]
    experts = expert_records_of(PLAN)
    summary = summarise("driving", PLAN, results, experts, "sheath experiment driving", 1.0)
    against = summary["methods"]["sheath"]["area"]["executed"]["minus_dagger"]
    assert against == {"runs": 0, "mean": None, "ci95": [None, None]}


def test_of_many_runs_a_metric_is_as_certain_as_the_runs_are_alike():
    plan = PLAN.changed(comparison={"seeds": tuple(range(10)), "evaluation_episodes": 4})
    results = results_of(plan)
    summary = summarise("driving", plan, results, expert_records_of(plan), "sheath", 1.0)
    policy = summary["methods"]["sheath"]["rounds"][3]["policy"]
    means = [
        np.mean([record.metrics["laps"] for record in result.policy])
        for result in results["sheath"]
        if result.round == 3
    ]
    assert policy["episodes"] == 40
    assert policy["ci95"]["laps"] == pytest.approx(list(bounded_interval(np.array(means))))


def test_many_seeds_are_one_word():
    assert seeds_shown(range(50)) == "0..49"
    assert seeds_shown([0, 1, 2]) == "0, 1, 2"
    assert seeds_shown([0, 1, 2, 3, 7]) == "0, 1, 2, 3, 7"


def test_what_is_not_a_number_is_null_and_the_file_reads_as_it_was_written(results, tmp_path):
    lost = {
        method: [replace(result, false_alarm_rate=math.nan, policy=()) for result in rounds]
        for method, rounds in results.items()
    }
    summary = summarise("driving", PLAN, lost, [], "sheath experiment driving", 1.0)
    json.dumps(summary, allow_nan=False)
    write_json(tmp_path / "summary.json", summary)
    assert json.loads((tmp_path / "summary.json").read_text()) == summary
    assert summary["methods"]["sheath"]["rounds"][1]["false_alarm_rate"] is None
    assert summary["methods"]["sheath"]["rounds"][1]["policy"]["failure_rate"] is None
    assert summary["expert"]["failure_rate"] is None
    Console(quiet=True).print(table(summary))


def test_a_run_that_stopped_early_is_summarised_by_the_rounds_it_has(results):
    results["sheath"] = [r for r in results["sheath"] if r.run_seed == 0 or r.round < 2]
    summary = summarise("driving", PLAN, results, [], "sheath experiment driving", 1.0)
    assert [entry["runs"] for entry in summary["methods"]["sheath"]["rounds"]] == [2, 2, 1, 1]


def test_the_table_fits_a_terminal(summary, capsys):
    Console(width=80).print(table(summary))
    shown = capsys.readouterr().out
    assert "…" not in shown
    for method in ("cloning", "dagger", "sheath", "random-"):
        assert method in shown


def test_the_table_fits_a_terminal_where_the_metric_has_a_unit(results, capsys):
    def tiles(records):
        return tuple(replace(r, metrics={"distance_tiles": 220.0}) for r in records)

    far = {
        f"{method}-own-labels" if method == "sheath" else method: [
            replace(
                result,
                executed=tiles(result.executed),
                policy=tiles(result.policy),
                final=tiles(result.final),
            )
            for result in rounds
        ]
        for method, rounds in results.items()
    }
    experts = tiles(expert_records_of(PLAN))
    Console(width=80).print(table(summarise("platformer", PLAN, far, experts, "sheath", 1.0)))
    assert "…" not in capsys.readouterr().out


def test_the_revision_says_whether_files_differ(tmp_path):
    assert git_revision(tmp_path) is None

    def git(*arguments: str) -> None:
        identity = ("-c", "user.name=a", "-c", "user.email=a@b")
        command = ("git", "-C", str(tmp_path), *identity, *arguments)
        subprocess.run(command, check=True, capture_output=True)

    git("init")
    assert git_revision(tmp_path) is None
    git("commit", "--allow-empty", "-m", "first")
    clean = git_revision(tmp_path)
    assert clean
    (tmp_path / "results").mkdir()
    (tmp_path / "results" / "summary.json").write_text("{}")
    assert git_revision(tmp_path) == clean
    (tmp_path / "code.py").write_text("")
    assert git_revision(tmp_path) == f"{clean}-dirty"


def test_a_single_value_is_shown_without_an_interval():
    assert with_interval(0.5, bounded_interval(np.array([0.5]))) == "0.50"
    # Not ±: what has bounds is not as uncertain upwards as downwards.
    assert with_interval(0.5, bounded_interval(np.array([0.25, 0.75]))).endswith(".25–.75[/dim]")


def test_who_learns_nothing_is_beside_the_methods(summary, results, capsys):
    figures = summary["methods"]["sheath"]["final"]
    held_against = summarise(
        "driving",
        PLAN,
        results,
        expert_records_of(PLAN),
        "sheath experiment driving",
        1.0,
        references={"by a plan": figures},
    )
    assert summary["references"] == {}
    assert held_against["references"] == {"by a plan": figures}
    Console(width=80).print(table(held_against))
    assert "by a plan" in capsys.readouterr().out
