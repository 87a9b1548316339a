"""What the comparison of rounds says, and that LeRobot must be there for it."""

import sys

import pytest

from tools.lerobot.compare import main
from tools.lerobot.comparison_plan import COMPARED, RANDOM, SHEATH, ComparisonPlan
from tools.lerobot.comparison_results import START, comparison_bars, through, together

PLAN = ComparisonPlan(rounds=2)


def found(start: int, **last: int):
    """What one training seed came to: successes of ten by method."""

    def alone(wins: int):
        return {"succeeds": [True] * wins + [False] * (10 - wins)}

    def learning(success: float, share: float, steps: int):
        counts = {"takeovers_an_episode": 2.0, "labels": 50, "episodes": 10, "steps": steps}
        return {"learning": {"success_rate": success, "expert_share": share, **counts}}

    first, second = learning(0.5, 0.3, 1000), learning(1.0, 0.1, 3000)
    methods = {
        name.replace("_", "-"): [first, second | {"alone": alone(wins)}]
        for name, wins in last.items()
    }
    return {"start": {"alone": alone(start)}, "methods": methods}


ALL = {"sheath": 8, "random_takeover": 6, "random_blocks": 7, "dagger": 9}


def test_seeds_count_together_once_every_method_is_through():
    whole, half = found(3, **ALL), found(3, sheath=8)
    assert list(through({20: whole, 21: half}, PLAN)) == [20]
    pooled = together({20: whole, 21: found(5, **ALL | {"sheath": 10})})
    assert list(pooled) == [START, *COMPARED]
    assert pooled[SHEATH]["success_rate"] == pytest.approx(0.9)
    assert pooled[SHEATH]["success_by_seed"] == {"20": 0.8, "21": 1.0}
    assert pooled[START]["success_rate"] == pytest.approx(0.4)
    low, high = pooled[RANDOM]["less_than_sheath_ci95"]
    assert 0 < low < 0.3 < high
    learning = pooled[SHEATH]["learning"]
    assert learning["success_rate"] == pytest.approx(0.75)
    assert learning["expert_share"] == pytest.approx(0.15)
    assert learning["labels"] == 200
    assert "learning" not in pooled[START]


@pytest.mark.parametrize(
    ("changed", "missed"),
    [
        ({}, []),
        ({"dagger": 2}, ["no method ends below its start"]),
        ({"sheath": 5, "random_takeover": 4}, ["SHEATH's last policy succeeds in .60"]),
        ({"random_takeover": 8}, ["SHEATH's last policy above random takeover's"]),
    ],
)
def test_each_bar_is_missed_by_itself(changed, missed):
    held = comparison_bars(together({20: found(3, **ALL | changed)}))
    assert [bar for bar, holds in held.items() if not holds] == missed


def test_without_lerobot_it_says_what_to_install(tmp_path, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "lerobot", None)
    # It tells LeRobot to ask no hub.
    monkeypatch.setattr("os.environ", {})
    assert main(["--runs", str(tmp_path), "--results", str(tmp_path / "results.json")]) == 2
    assert "pip install 'sheath-manip[lerobot]'" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())
