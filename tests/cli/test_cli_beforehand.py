"""What cannot be learned is said before the first episode; and a run that is begun anew."""

from dataclasses import replace

import numpy as np
import pytest

from sheath_manip.exceptions import ParameterError
from sheath_manip.learning.beforehand import require_learnable
from sheath_manip.rollout.serial import SerialExecutor
from sheath_manip.types import ActionSpec
from tests.cli.test_cli_failures import LEARN
from tests.toy import PLAN, Corridor

CLASSIFIER = PLAN.changed(policy={"name": "hog-svm"}, gate={"embedding": "pixels"})
EYELESS = PLAN.changed(
    policy={"name": "linear-svm"},
    gate={"embedding": "features", "precedent_embedding": "features"},
)
BUTTONS = ActionSpec(
    ("left",), np.zeros(1, np.float32), np.ones(1, np.float32), np.eye(2, 1, dtype=np.float32)
)


@pytest.fixture
def no_episode(monkeypatch) -> None:
    def run(*_):
        raise AssertionError("wanted an error before any episode")

    monkeypatch.setattr(SerialExecutor, "map", run)


@pytest.mark.usefixtures("no_episode")
@pytest.mark.parametrize("verb", ["learn", "experiment"])
def test_an_embedding_that_does_not_go_with_the_policy_is_told_at_once(verb, complaint, tmp_path):
    runs = tmp_path / "runs"
    wrong = ("--gate.embedding", "tool-points")
    more = () if verb == "learn" else ("--methods", "sheath", "--workers", 0)
    line = complaint(verb, "corridor", "--runs", runs, *more, *wrong)
    assert "embedding" in line
    # Else the right settings would be those of another run.
    assert not runs.exists()


def test_a_task_without_choices_has_no_classifier():
    spec = Corridor().spec
    require_learnable(spec, CLASSIFIER, ["sheath", "smile", "sheath-plain"])
    continuous = replace(spec, action=replace(spec.action, choices=None))
    with pytest.raises(ParameterError, match="admissible actions"):
        require_learnable(continuous, CLASSIFIER, [])


def test_a_task_without_a_camera_has_no_pixels():
    blind = replace(Corridor().spec, cameras={}, action=BUTTONS)
    require_learnable(blind, EYELESS, ["sheath", "sheath-plain"])
    pixels = EYELESS.changed(gate={"embedding": "pixels"})
    with pytest.raises(ParameterError, match="no camera"):
        require_learnable(blind, pixels, [])
    # What no gate looks at need not be made.
    require_learnable(blind, pixels.changed(gate={"kind": "human"}), [])


def test_learn_begins_anew_and_keeps_what_there_was(sheath, complaint, tmp_path):
    runs = tmp_path / "runs"
    learn = ("learn", "corridor", "--runs", runs, *LEARN)
    assert sheath(*learn)[0] == 0
    other = (*learn, "--gate.quiet-steps", 7)
    assert "or start it afresh with --fresh" in complaint(*other)
    code, out, _ = sheath(*other, "--fresh")
    assert code == 0
    assert f"the earlier run is kept in {runs}-before-1" in out
    assert (tmp_path / "runs-before-1" / "plan.json").exists()
