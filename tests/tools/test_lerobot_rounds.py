"""What LeRobot is given to learn of our episodes, and what of the rounds counts as shown."""

import sys

import pytest

from sheath_manip.exceptions import ParameterError
from tests.episodes import episode_of
from tools.lerobot.__main__ import main
from tools.lerobot.bars import METHODS, bars
from tools.lerobot.plan import QUICK, Plan, claim
from tools.lerobot.sets import parts


def test_a_chunk_never_crosses_a_change_of_who_acts():
    columns = episode_of("eeeppee", "xxx..xx").columns
    assert [(rows.start, rows.stop) for rows in parts(columns)] == [(0, 3), (5, 7)]


def test_of_the_policys_labelled_steps_some_are_learned_from_each_by_itself():
    columns = episode_of("e" + 7 * "p" + "e", "x" * 9).columns
    wanted = [(0, 1), (8, 9), (1, 2), (6, 7)]
    assert [(rows.start, rows.stop) for rows in parts(columns)] == wanted


def test_without_a_label_there_is_nothing_to_learn():
    columns = episode_of("epe", "...").columns
    assert not list(parts(columns))


def results(**last):
    """As a run writes them, with the success of each method's last policy."""
    return {
        "start": {
            "alone": {"success_rate": 0.3, "episodes": 40},
            "lerobots_own_loop": {"successes": 12},
            "judged": {"judged_is_given": 500, "policy_steps": 500},
            "forward_passes": 80,
            "chunks": 80,
            "false_alarms": {"asked": 0.05, "found": 0.06},
        },
        "methods": {name: [{"alone": {"success_rate": rate}}] for name, rate in last.items()},
    }


def test_all_bars_hold_or_are_told_one_by_one():
    rates = dict(zip(METHODS, (0.7, 0.5, 0.3), strict=True))
    assert all(bars(results(**rates)).values())
    assert len(bars(results(**rates))) == 7
    assert len(bars(results(sheath=0.7))) == 4
    missed = [name for name, held in bars(results(**rates | {"sheath": 0.5})).items() if not held]
    assert missed == [
        "SHEATH's last policy succeeds in .60",
        "SHEATH's last policy above random takeover's",
    ]
    assert not bars(results(**rates | {"dagger": 0.29}))["no method ends below its start"]


@pytest.mark.parametrize(
    ("name", "worse"),
    [
        ("lerobots_own_loop", {"successes": 15}),
        ("judged", {"judged_is_given": 499, "policy_steps": 500}),
        ("forward_passes", 81),
        ("false_alarms", {"asked": 0.05, "found": 0.081}),
    ],
)
def test_each_count_of_the_start_has_its_bar(name, worse):
    start = results()["start"]
    held = bars({"start": start | {name: worse}, "methods": {}})
    assert list(held.values()).count(False) == 1


def test_a_folder_belongs_to_one_plan(tmp_path):
    claim(tmp_path / "runs", QUICK)
    claim(tmp_path / "runs", QUICK)
    with pytest.raises(ParameterError, match="another plan"):
        claim(tmp_path / "runs", Plan())


def test_without_lerobot_it_says_what_to_install(tmp_path, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "lerobot", None)
    # It tells LeRobot to ask no hub.
    monkeypatch.setattr("os.environ", {})
    assert main(["--runs", str(tmp_path), "--results", str(tmp_path / "results.json")]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert "pip install 'sheath-manip[lerobot]'" in said
    assert not list(tmp_path.iterdir())
