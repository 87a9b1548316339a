"""A policy alone, gated and at random takeovers on the same scenes: on the toy task."""

from dataclasses import replace

import pytest

from sheath_manip.experiments.takeovers.trial import Trial, read_trials
from sheath_manip.types import Outcome
from tests.toy import PLAN, STUDY
from tools.outside.gated import summarised
from tools.outside.on_scenes import ALONE, AT_RANDOM, GATED, WAYS, OnScenes

SCENES = 5


def test_all_ways_meet_the_same_scenes_and_what_is_done_is_read(tmp_path, monkeypatch):
    plan = PLAN.changed(
        policy={"settings": {"epochs": 10}},
        # So many states are outside that there is something to share out.
        gate={
            "signal": "support",
            "embedding": "pixels",
            "threshold": {"false_alarm_rate": 0.3},
        },
        comparison={"final_episodes": SCENES},
    )
    said: list[str] = []
    at = OnScenes(STUDY, plan, 3, tmp_path, said.append)
    trials = at.trials()
    assert list(trials) == list(WAYS)
    assert len(said) == 1 + len(WAYS)
    seeds = [trial.seed for trial in trials[ALONE]]
    assert len(set(seeds)) == SCENES
    assert all([trial.seed for trial in of] == seeds for of in trials.values())
    assert all(not trial.turns for trial in trials[ALONE])
    assert any(trial.turns for trial in trials[GATED])
    failing = [trial.fails for trial in trials[ALONE]]
    assert all([trial.failing for trial in of] == failing for of in trials.values())
    lengths = {count for trial in trials[GATED] for _, count in trial.turns}
    # At the end of an episode a block is cut short.
    blocks = [turn for trial in trials["random-blocks"] for turn in trial.turns[:-1]]
    assert all(count >= min(lengths) for _, count in blocks)

    (at.folder / f"{GATED}.json").unlink()
    again = OnScenes(STUDY, plan, 3, tmp_path, said.append).trials()
    assert again == trials
    monkeypatch.setattr(OnScenes, "_try", None)
    assert at.trials() == trials
    assert read_trials(at.folder / f"{ALONE}.json")[ALONE] == trials[ALONE]


def way(*ended: Outcome, turns=()):
    """Trials of scenes 0, 1, ... of which the policy alone fails in the odd ones."""
    return [Trial(scene, scene % 2 == 1, each, 100, turns) for scene, each in enumerate(ended)]


def test_success_and_burden_are_told_of_all_training_seeds_together():
    won, lost, stuck = Outcome.SUCCESS, Outcome.FAILURE, Outcome.TIME_LIMIT
    turns = ((0, 10), (50, 20))
    of = {
        ALONE: way(won, stuck, won, lost),
        GATED: way(won, won, lost, won, turns=turns),
        **{name: way(won, lost, won, lost, turns=turns) for name in AT_RANDOM},
    }
    better = of | {GATED: way(won, won, won, won, turns=turns)}
    plan = replace(PLAN)
    found = summarised("toy", plan, {7: of, 8: better}, 20.0, "python -m tools")
    assert found["seeds"] == [7, 8]
    ways = found["ways"]
    assert ways[GATED]["episodes"] == 8
    assert ways[GATED]["success_rate"] == pytest.approx(7 / 8)
    assert ways[GATED]["success_by_seed"] == {"7": 0.75, "8": 1.0}
    assert (ways[GATED]["broken"], ways[ALONE]["broken"]) == (1, 0)
    assert ways[ALONE]["stuck_rate"] == ways[ALONE]["failure_rate"] == 0.25
    burden = ways[GATED]["burden"]
    assert burden["takeovers_an_episode"] == 2.0
    assert burden["takeovers_a_minute"] == pytest.approx(24.0)
    assert ways[GATED]["expert_share"] == pytest.approx(0.3)
    assert ways[GATED]["fails_more_than_gated_ci95"] == [0.0, 0.0]
    assert ways["random-steps"]["fails_more_than_gated_ci95"][1] > 0
