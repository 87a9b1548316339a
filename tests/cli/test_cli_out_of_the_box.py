"""A task without a study, a camera or choices: learned, trained and judged with nothing named."""

from dataclasses import replace

import numpy as np

from sheath_manip.cli.entry import run_command
from sheath_manip.cli.session import Catalog
from sheath_manip.gates.config import GateConfig
from sheath_manip.learning.config import LearningPlan
from sheath_manip.learning.suited import suited
from sheath_manip.task import Task
from sheath_manip.types import Action, ActionSpec, Observation
from tests import blobs, buttons, reach
from tests.toy import Corridor

SUITED = "policy mlp, signal near-joined, embedding scaled-features"


class Glide(Corridor):
    """The corridor with sidesteps of any width, and no camera."""

    def __init__(self, steps: int = 10) -> None:
        super().__init__(steps)
        bound = np.array([0.5], np.float32)
        action = ActionSpec(("sidestep_m",), -bound, bound, tolerance=0.1)
        self.spec = replace(self.spec, name="glide", cameras={}, action=action)

    def _observation(self) -> Observation:
        return replace(super()._observation(), images={})


class Back:
    """Steps back to the middle."""

    def __init__(self, environment: Glide) -> None:
        self.environment = environment

    def reset(self) -> None:
        pass

    def act(self, observation: Observation) -> Action:
        del observation
        return np.clip([-0.7 * self.environment.side_m], -0.5, 0.5).astype(np.float32)


GLIDE = Task(
    name="glide",
    summary="keep to the middle of a windy corridor, unseen",
    variants={"default": Glide, "final": Glide},
    expert=Back,
)


def run(*argv: object) -> int:
    return run_command(lambda: Catalog({"glide": GLIDE}, {}), [str(word) for word in argv])


def test_a_task_of_features_and_continuous_actions_is_learned_with_nothing_named(tmp_path, capsys):
    quick = ("--policy.name", "mlp", "--policy.settings", '{"steps": 200, "warm_steps": 20}')
    few = ("--demonstrations", 4, "--calibration", 3, "--false-alarm-episodes", 1, "--rounds", 1)
    fewer = ("--episodes", 1, "--evaluation-episodes", 2, "--final-episodes", 1)
    assert run("learn", "glide", "--runs", tmp_path / "runs", *quick, *few, *fewer) == 0
    assert SUITED in capsys.readouterr().err.replace("\n", " ")
    store = tmp_path / "runs" / "store"
    first = tmp_path / "first.npz"
    line = ("--store", store, "--checkpoint", first, "--calibration", 3)
    assert run("train", "glide", *line, *quick) == 0
    assert SUITED in capsys.readouterr().err.replace("\n", " ")
    assert run("evaluate", "glide", "--checkpoint", first, "--episodes", 3, "--json") == 0
    assert '"failure_rate"' in capsys.readouterr().out


def test_what_nobody_chose_suits_the_task():
    blind = Glide().spec
    plan, line = suited(blind, LearningPlan())
    assert plan.policy.name == "mlp"
    assert SUITED in line
    # The wanted choice of policy is where the embedding follows.
    plan, _ = suited(reach.SPEC, LearningPlan())
    assert (plan.policy.name, plan.gate.signal) == ("spatial-cnn", "near-joined")
    assert plan.gate.embedding == "camera-convolutions-whitened"
    plan, _ = suited(buttons.SPEC, LearningPlan())
    assert (plan.policy.name, plan.gate.signal) == ("mlp", "joined")
    plan, _ = suited(reach.SPEC, LearningPlan().changed(policy={"name": "act"}))
    assert plan.gate.embedding == "camera-convolutions-whitened"


def test_what_somebody_chose_stays():
    assert suited(blobs.SPEC, LearningPlan()) == (LearningPlan(), "")
    mine = LearningPlan().changed(policy={"name": "mine"}, gate={"embedding": "mine"})
    assert suited(Glide().spec, mine) == (mine, "")
    assert suited(buttons.SPEC, buttons.PLAN) == (buttons.PLAN, "")
    settled = LearningPlan(gate=GateConfig(quiet_steps=3, minimum_hold_steps=5))
    plan, _ = suited(Glide().spec, settled)
    assert (plan.gate.quiet_steps, plan.gate.minimum_hold_steps) == (3, 5)
