"""The whole benchmark of takeovers, small, on the toy task."""

import io
import json
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from sheath_manip.exceptions import ParameterError, StoreError, UnknownNameError
from sheath_manip.experiments.takeovers.alone import Alone
from sheath_manip.experiments.takeovers.benchmark import run_takeovers
from sheath_manip.experiments.takeovers.plan import (
    BASELINES_OF,
    FRESH,
    GateChoice,
    Kind,
    Quota,
    TakeoversPlan,
)
from sheath_manip.experiments.takeovers.recalled import RecallingGate
from sheath_manip.experiments.takeovers.scoring import scene_key, scores_alone
from sheath_manip.experiments.takeovers.trial import Trial, read_trials
from sheath_manip.experiments.takeovers.trying import Place, try_gates
from sheath_manip.experiments.takeovers.watched import Watched
from sheath_manip.learning.checkpoint import load_checkpoint
from sheath_manip.rollout import rollout
from sheath_manip.rollout.cached_expert import CachedExpert
from sheath_manip.rollout.executing import Executing
from sheath_manip.support.calibration import level_threshold
from sheath_manip.types import Observation
from tests.experiments.test_figures_generic import assert_shows_something
from tests.toy import PLAN, Corridor
from tests.toy import STUDY as TOY

SMALL = TakeoversPlan(
    seeds=(0,),
    rounds=(0, 1),
    scenes=Quota(failing=3, succeeding=1, most=12),
    kinds=(Kind("default", 0.3), Kind("precedent", 0.3, notices_stuck=True)),
    levels=(-1.0, 0.0, 0.3),
    takeovers=(0.5, 1.0),
    shares=(0.1,),
    oracle=1,
)


class Foggy(Corridor):
    """Windier, and shows nothing of the robot where it is far from the middle."""

    def reset(self, seed: int) -> Observation:
        seen = super().reset(seed)
        self._gusts_m *= 1.9
        return seen

    def _observation(self) -> Observation:
        seen = super()._observation()
        if abs(self.side_m) < 0.4:
            return seen
        return replace(seen, images={"above": np.full_like(seen.images["above"], 100)})


STUDY = replace(
    TOY,
    task=replace(TOY.task, variants={"default": Foggy, "final": Foggy}),
    plans={
        "full": PLAN.changed(
            policy={"name": "hog-svm"},
            gate={"embedding": "pixels", "precedent_embedding": "pixels", "stuck_steps": 12},
            schedule={"demonstrations": 1, "calibration": 6, "false_alarm_episodes": 1},
        )
    },
)


def benchmark(directory: Path, workers: int = 0, plan: TakeoversPlan = SMALL) -> dict:
    return run_takeovers(
        [STUDY],
        plan,
        runs=directory / "runs",
        results=directory / "results",
        command="sheath experiment takeovers",
        executing=Executing(workers=workers),
        console=Console(file=io.StringIO()),
    )


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> Path:
    directory = tmp_path_factory.mktemp("takeovers")
    benchmark(directory)
    return directory


def watched(directory: Path, rounds: int = 0) -> Watched:
    return Watched(STUDY, SMALL, directory / "runs" / "corridor", 0, rounds)


def trials_of(directory: Path) -> dict[str, bytes]:
    runs = directory / "runs"
    return {
        str(path.relative_to(runs)): path.read_bytes()
        for path in sorted(runs.rglob("*.json"))
        if not path.name.startswith("wall")
        and "store" not in path.parts
        and "dagger" not in path.parts
        and "expert" not in path.parts
    }


def test_each_target_has_its_gate_and_its_baselines(whole):
    found = json.loads((whole / "results" / "summary.json").read_text())["tasks"]["corridor"]
    assert [(each["axis"], each["value"]) for each in found["targets"]] == [
        ("takeovers", 0.5),
        ("takeovers", 1.0),
        ("share", 0.1),
    ]
    for target in found["targets"]:
        ways = target["ways"]
        assert list(ways) == ["gate", *BASELINES_OF[target["axis"]]]
        scenes = {way["scenes"] for way in ways.values()}
        assert scenes == {sum(min(3, each["failing"]) for each in found["policies"].values())}
    for path in (whole / "results").glob("*.png"):
        assert_shows_something(path)


def test_going_on_from_the_first_takeover_is_the_whole_episode(whole):
    at = watched(whole)
    environment = at.environment()
    checkpoint = load_checkpoint(at.fitted_path("default"), environment.spec)
    scores = scores_alone(at, FRESH, "default")
    threshold = level_threshold([np.load(at.held_out_path("default"))], 0.3)
    rate_hz = environment.spec.control_rate_hz
    hold = max(1, round(0.3 * rate_hz))
    fitted = checkpoint.fitted
    config = replace(fitted.config, minimum_hold_steps=hold, labels="own")
    checkpoint = replace(checkpoint, fitted=replace(fitted, config=config, threshold=threshold))
    here = Place(at, FRESH, environment, checkpoint)
    (tried,) = try_gates(at, FRESH, [GateChoice("default", 0.3, notices_stuck=True, level=0.3)])
    began_late = 0
    for scene, trial in zip(here.scenes, tried, strict=True):
        alone = here.alone(scene)
        episode = rollout(
            environment,
            alone.info,
            checkpoint.gate(),
            rng=np.random.default_rng(0),
            policy=checkpoint.policy,
            expert=CachedExpert(at.task.expert(environment)),
        )
        assert Trial.of(episode, scene.failing) == trial
        gate = RecallingGate(checkpoint.gate(), alone.steps, scores[scene_key(scene)])
        began_late += gate.first is not None and gate.first > 0
    assert began_late > 0
    environment.close()


@pytest.mark.parametrize("workers", [0, pytest.param(2, marks=pytest.mark.soak)])
def test_workers_and_interruptions_change_nothing(whole, tmp_path, workers):
    shutil.copytree(whole / "runs", tmp_path / "runs")
    for name in (
        "choices.json",
        "s0-r1/fresh/gates.json",
        "s0-r0/fresh/baselines.json",
        "s0-r0/fresh/oracle.json",
        "s0-r0/tuning/default-0.3s.json",
    ):
        (tmp_path / "runs" / "corridor" / name).unlink()
    benchmark(tmp_path, workers)
    assert trials_of(tmp_path) == trials_of(whole)


def test_what_the_results_hold_of_other_tasks_stays(whole, tmp_path):
    shutil.copytree(whole, tmp_path, dirs_exist_ok=True)
    file = tmp_path / "results" / "summary.json"
    known = json.loads(file.read_text())["tasks"]["corridor"]
    file.write_text(json.dumps({"experiment": "takeovers", "tasks": {"elsewhere": known}}))
    found = benchmark(tmp_path, plan=replace(SMALL, tasks=("corridor",)))["tasks"]
    assert found["elsewhere"] == known
    assert found["corridor"]["targets"] == known["targets"]
    assert found["corridor"]["run"]["tasks"] == ["corridor"]
    file.write_text(json.dumps({"tasks": 3}))
    with pytest.raises(StoreError, match="no result of takeovers"):
        benchmark(tmp_path)


def test_the_oracle_saves_what_the_policy_alone_loses(whole):
    for rounds in SMALL.rounds:
        at = watched(whole, rounds)
        if Alone.read(at, FRESH).failing:
            (trial,) = read_trials(at.trials_path(FRESH, "oracle"))["oracle"]
            assert not trial.fails
            assert trial.turns


def test_unknown_tasks_and_other_settings_are_refused(whole):
    with pytest.raises(UnknownNameError, match="corridor"):
        benchmark(whole, plan=replace(SMALL, tasks=("nowhere",)))
    with pytest.raises(ParameterError, match="oracle"):
        benchmark(whole, plan=replace(SMALL, oracle=2))
