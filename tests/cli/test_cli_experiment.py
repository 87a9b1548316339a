"""What `sheath experiment` hands over, without running it."""

import os
import sys
import types
from pathlib import Path

import pytest

from sheath_manip.cli.planned import asked_policy
from sheath_manip.experiments.gates.plan import PLANS
from sheath_manip.experiments.scale.costs import Costs, Line, MethodCosts
from sheath_manip.learning.config import LearningPlan
from sheath_manip.policies.config import PolicyConfig
from sheath_manip.rollout.executing import Executing
from tests.toy import PLAN, STUDY


@pytest.fixture
def asked(monkeypatch, tmp_path) -> list[dict]:
    """What `run_experiment` is asked for, without running it, in an empty working directory."""
    calls = []

    def run_experiment(study, plan, **options):
        calls.append({"study": study, "plan": plan} | options)

    stand_in = types.ModuleType("sheath_manip.experiments.learning")
    stand_in.__dict__["run_experiment"] = run_experiment
    monkeypatch.setitem(sys.modules, stand_in.__name__, stand_in)
    monkeypatch.chdir(tmp_path)
    return calls


def test_experiment_hands_over_its_settings(sheath, asked):
    argv = ("experiment", "corridor", "--seeds", 4, 5, "--rounds", 3, "--methods", "cloning")
    assert sheath(*argv, "--workers", 1)[0] == 0
    (call,) = asked
    assert call["study"] is STUDY
    assert (call["plan"].comparison.seeds, call["plan"].schedule.rounds) == ((4, 5), 3)
    assert call["plan"].comparison.methods == ("cloning",)
    assert (call["runs"], call["results"]) == (Path("runs/corridor"), Path("results/corridor"))
    assert (call["executing"], list(call["listeners"])) == (Executing(workers=1), [])
    assert call["command"] == (
        "sheath experiment corridor --seeds 4 5 --rounds 3 --methods cloning --workers 1"
    )


def test_experiment_takes_settings_of_every_part(sheath, asked):
    argv = ("experiment", "corridor", "--gate.support.nu", 0.2, "--policy.name", "hog-svm")
    settings = ("--policy.settings", '{"bins": 4}', "--demonstrations", 5)
    assert sheath(*argv, *settings, "--final-variant", "default")[0] == 0
    assert asked[0]["plan"] == PLAN.changed(
        policy={"name": "hog-svm", "settings": {"bins": 4}},
        gate={"support": {"nu": 0.2}},
        schedule={"demonstrations": 5},
        comparison={"final_variant": "default"},
    )


def test_help_of_a_task_has_its_plans_values(sheath, monkeypatch):
    # One column: in several, lines break where the longest option wants it.
    monkeypatch.setenv("COLUMNS", "80")
    _, out, _ = sheath("experiment", "corridor", "--plan", "quick", "--help")
    assert "expert episodes before round 1 (default: 4)" in out
    _, out, _ = sheath("experiment", "--help")
    assert "expert episodes before round 1 (default: 10)" in out


def test_another_policy_does_not_get_the_settings_of_the_plans():
    plan = LearningPlan(policy=PolicyConfig("cnn", {"steps": 4}))
    assert asked_policy(PolicyConfig("hog-svm", {"steps": 4}), plan) == PolicyConfig("hog-svm")
    own = PolicyConfig("hog-svm", {"bins": 4})
    assert asked_policy(own, plan) == own
    assert asked_policy(plan.policy, plan) == plan.policy


def test_experiment_quick_stays_out_of_the_results(sheath, asked):
    code, out, _ = sheath("experiment", "corridor", "--quick", "--dashboard", "--port", 0)
    assert code == 0
    assert "http://127.0.0.1:" in out
    (call,) = asked
    assert call["plan"] == PLAN
    runs = Path("runs/corridor-quick")
    assert (call["runs"], call["results"]) == (runs, runs / "results")
    assert (call["executing"], len(call["listeners"])) == (Executing(workers=0), 1)


def test_experiment_takes_at_most_the_cores(sheath, asked, monkeypatch):
    monkeypatch.setattr(os, "cpu_count", lambda: 1)
    assert sheath("experiment", "corridor")[0] == 0
    assert asked[0]["executing"] == Executing(workers=1)


def test_experiment_goes_to_a_cluster(sheath, asked):
    argv = ("experiment", "corridor", "--executor", "ray")
    assert sheath(*argv)[0] == 0
    assert sheath(*argv, "--workers", 64, "--address", "head:6379")[0] == 0
    assert [call["executing"] for call in asked] == [
        Executing("ray"),
        Executing("ray", 64, "head:6379"),
    ]


def test_experiment_estimates_and_runs_nothing_else(sheath, asked, monkeypatch):
    def measured(task, plan, directory, report) -> Costs:
        del task, directory, report
        method = MethodCosts(1.0, 1.0, Line(1.0, 0.0), 1.0, 10.0)
        return Costs(
            1.0, 1.0, 10.0, Line(1.0, 0.0), dict.fromkeys(plan.comparison.methods, method), 1e6, 1e5
        )

    monkeypatch.setattr("sheath_manip.experiments.scale.estimate.measure_costs", measured)
    code, out, _ = sheath("experiment", "corridor", "--estimate")
    assert code == 0
    assert "4 devices" in out
    assert "the longest chain is" in out
    assert asked == []
    assert Path("runs/corridor-estimate/costs.json").exists()


def test_experiment_fresh_keeps_the_earlier_run(sheath, asked, tmp_path):
    for content in ("first", "second"):
        (tmp_path / "runs").mkdir(parents=True)
        (tmp_path / "runs" / "plan.json").write_text(content)
        argv = ("experiment", "corridor", "--fresh", "--runs", tmp_path / "runs")
        code, out, _ = sheath(*argv)
        assert code == 0
        assert "the earlier run is kept" in out
    kept = [(tmp_path / f"runs-before-{n}" / "plan.json").read_text() for n in (1, 2)]
    assert kept == ["first", "second"]
    assert len(asked) == 2


def test_experiment_gates_takes_all_tasks(sheath, monkeypatch, tmp_path):
    calls = []

    def run_gates(studies, plan, **options):
        calls.append({"studies": list(studies), "plan": plan} | options)

    monkeypatch.setattr("sheath_manip.experiments.gates.benchmark.run_gates", run_gates)
    monkeypatch.chdir(tmp_path)
    assert sheath("experiment", "gates", "--seeds", 1, 2)[0] == 0
    assert sheath("experiment", "gates", "--quick", "--workers", 0)[0] == 0
    full, quick = calls
    assert full["studies"] == [STUDY]
    assert full["plan"].seeds == (1, 2)
    assert (full["runs"], full["results"]) == (Path("runs/gates"), Path("results/gates"))
    assert full["command"] == "sheath experiment gates --seeds 1 2"
    assert quick["plan"] == PLANS["quick"]
    assert quick["executing"] == Executing(workers=0)
    runs = Path("runs/gates-quick")
    assert (quick["runs"], quick["results"]) == (runs, runs / "results")
