"""The grasp in clutter joins the experiments, and its task knows left from right by a sign only."""

import io
import json

import numpy as np
import pytest
from PIL import Image
from rich.console import Console

from sheath_manip.experiments.learning import run_experiment
from sheath_manip.rollout.executing import Executing
from sheath_manip.tasks.grasp_clutter.entry import make
from sheath_manip.tasks.grasp_clutter.study.entry import STUDY
from sheath_manip.tasks.grasp_clutter.task import GraspTask, Scenario
from sheath_manip.tasks.robots.jaco import JACO_WITH_JAW


@pytest.mark.parametrize(
    "scenario", [Scenario(cameras=("shoulder",)), Scenario(robot=JACO_WITH_JAW)]
)
def test_what_stands_aside_has_no_mirror(scenario):
    environment = make(scenario)
    assert environment.spec.mirror is None
    environment.close()


def test_the_mirrored_arm_does_the_mirrored_thing():
    environment = make(Scenario(command_filter=False))
    mirror = environment.spec.mirror
    assert mirror is not None
    environment.reset(0)
    task, physics = environment.task, environment.physics
    assert isinstance(task, GraspTask)
    joints = np.array([0.2, -1.5, 1.9, 1.0, 0.1, 0.3])
    action = np.array([0.3, 0.5, -0.2, 0.1, 0.2, 0.4, -1.0], np.float32)
    joint_signs, action_signs = np.array(mirror.features[:6]), np.array(mirror.action, np.float32)
    reached = []
    for start, wish in ((joints, action), (joints * joint_signs, action * action_signs)):
        task.lay(physics, task.scene, start)
        for _ in range(5):
            environment.step(wish)
        reached.append(environment.observe().features)
    environment.close()
    np.testing.assert_allclose(reached[1], reached[0] * mirror.features, atol=2e-3)


@pytest.mark.soak
def test_a_small_experiment_with_a_film(tmp_path):
    plan = STUDY.plans["quick"].changed(
        policy={"settings": {"steps": 4, "warm_steps": 2}},
        comparison={"methods": ("sheath",), "evaluation_episodes": 1, "final_episodes": 1},
        schedule={
            "demonstrations": 2,
            "calibration": 3,
            "false_alarm_episodes": 1,
            "rounds": 1,
            "episodes": 1,
        },
    )
    run_experiment(
        STUDY,
        plan,
        runs=tmp_path / "runs",
        results=tmp_path / "results",
        command="sheath",
        executing=Executing(workers=0),
        figures=("film_strip.png", "intervention.gif"),
        console=Console(file=io.StringIO()),
    )
    summary = json.loads((tmp_path / "results" / "summary.json").read_text())
    assert summary["metric"] == "success"
    assert summary["expert"]["success_rate"] == 1.0
    with Image.open(tmp_path / "results" / "intervention.gif") as film:
        assert film.width == 720
