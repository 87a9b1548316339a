"""Checkpoints of schema 2 are read with the plan of their run beside them."""

import json
from pathlib import Path

import numpy as np
import pytest

from sheath_manip.exceptions import CheckpointError
from sheath_manip.files.json_files import plain
from sheath_manip.gates.config import GateConfig, planned_signal
from sheath_manip.gates.fitted import Sources
from sheath_manip.gates.labels.every_step import EveryStep
from sheath_manip.gates.labels.gate import LabellingGate
from sheath_manip.gates.query import QueryFilter
from sheath_manip.gates.support import SupportGate
from sheath_manip.learning.checkpoint import Checkpoint, load_checkpoint
from sheath_manip.learning.config import LearningPlan
from sheath_manip.learning.fitting import fit_gate
from sheath_manip.learning.methods import METHODS
from sheath_manip.support.config import SupportConfig, ThresholdConfig
from tests.blobs import SPEC, blob_samples, fitted_policy, held_out, training

CONFIG = GateConfig(
    signal="joined",
    embedding="pixels",
    precedent_embedding="pixels",
    support=SupportConfig(nu=0.2, bandwidth_factor=0.5),
    threshold=ThresholdConfig(false_alarm_rate=0.2),
    release_margin=0.01,
    quiet_steps=1,
    minimum_hold_steps=5,
)
FLAT = {
    "policy": "hog-svm",
    "policy_settings": {},
    "signal": "joined",
    "embedding": "pixels",
    "precedent_embedding": "pixels",
    "support": "one-class-svm",
    "nu": 0.2,
    "bandwidth_factor": 0.5,
    "threshold_rule": "steps",
    "false_alarm_rate": 0.2,
    "release_margin": 0.01,
    "quiet_steps": 1,
    "minimum_hold_steps": 5,
    "refit_unused": True,
    "demonstrations": 4,
}
"""a plan as it was written then"""


@pytest.fixture(scope="module")
def checkpoint() -> Checkpoint:
    policy = fitted_policy("hog-svm")
    usual = [blob_samples(50, seed=10 + number) for number in range(3)]
    fit = fit_gate(policy, training(), usual, CONFIG, sources=Sources(("a",), ("b",)))
    return Checkpoint(SPEC.name, "hog-svm", policy, fit.gate, "sheath", 2, 1, fit.training_loss)


def of_schema_2(checkpoint: Checkpoint, path: Path, **changes) -> Path:
    """The same as a file of that schema: other words in the header, the same arrays."""
    with np.load(checkpoint.save(path)) as file:
        arrays = dict(file)
    new = json.loads(str(arrays["header"]))
    choice = planned_signal(checkpoint.fitted.config)
    header = {
        "format": new["format"],
        "schema": 2,
        "task": new["task"],
        "policy": new["policy"],
        "signal": {
            "signal": choice.signal,
            "embedding": choice.embedding,
            "support": choice.support,
            "precedent_embedding": choice.precedent_embedding,
            "hyperparameters": dict(choice.hyperparameters),
        },
        "threshold": new["threshold"],
        "release_margin": new["release_margin"],
        "false_alarm_rate": 0.2,
        "method": new["method"],
        "round": new["round"],
        "run_seed": new["run_seed"],
    }
    written = {name: value for name, value in (header | changes).items() if value is not None}
    np.savez(path, allow_pickle=False, **(arrays | {"header": np.array(json.dumps(written))}))
    return path


def in_a_run(directory: Path, plan: dict | None) -> Path:
    """Where a run lays the checkpoint of a round, and its plan."""
    path = directory / "s1" / "sheath" / "round-02.npz"
    path.parent.mkdir(parents=True)
    if plan is not None:
        (directory / "plan.json").write_text(json.dumps(plan))
    return path


@pytest.mark.parametrize(
    "plan", [FLAT, plain(LearningPlan(gate=CONFIG).described())], ids=["flat", "nested"]
)
def test_with_the_plan_of_its_run_it_has_the_gate_that_it_was_trained_with(
    plan, checkpoint, tmp_path
):
    loaded = load_checkpoint(of_schema_2(checkpoint, in_a_run(tmp_path, plan)), SPEC)
    assert loaded.fitted.config == CONFIG
    assert (loaded.threshold, loaded.method, loaded.round, loaded.run_seed) == (
        checkpoint.threshold,
        "sheath",
        2,
        1,
    )
    np.testing.assert_array_equal(
        loaded.fitted.scores(held_out()), checkpoint.fitted.scores(held_out())
    )
    labelling = loaded.gate()
    assert isinstance(labelling, LabellingGate)
    assert [type(rule) for rule in labelling.rules] == [EveryStep]
    gate = labelling.gate
    assert isinstance(gate, SupportGate)
    assert (gate.quiet_steps, gate.minimum_hold_steps) == (1, 5)
    # Which episodes it was fitted to was not written then.
    assert loaded.fitted.sources == Sources()


@pytest.mark.parametrize(
    ("method", "kind", "labels"),
    [("sheath-own-labels", SupportGate, "own"), ("shiv", QueryFilter, "all")],
)
def test_its_method_says_who_acts_and_what_is_labelled(method, kind, labels, checkpoint, tmp_path):
    path = of_schema_2(checkpoint, in_a_run(tmp_path, FLAT), method=method)
    loaded = load_checkpoint(path, SPEC)
    assert isinstance(loaded.gate(), kind)
    assert loaded.fitted.config.labels == labels
    assert loaded.fitted.config == METHODS[method].plan(LearningPlan(gate=CONFIG)).gate


def test_one_from_before_there_was_a_release_margin_has_none(checkpoint, tmp_path):
    path = of_schema_2(checkpoint, in_a_run(tmp_path, FLAT), release_margin=None)
    assert load_checkpoint(path, SPEC).fitted.release_margin == 0


def test_saved_again_it_needs_no_plan(checkpoint, tmp_path):
    loaded = load_checkpoint(of_schema_2(checkpoint, in_a_run(tmp_path, FLAT)), SPEC)
    again = load_checkpoint(loaded.save(tmp_path / "elsewhere" / "again.npz"), SPEC)
    assert again.fitted.config == CONFIG
    assert again.threshold == checkpoint.threshold


def test_without_its_plan_one_line_says_what_is_missing(checkpoint, tmp_path):
    path = of_schema_2(checkpoint, in_a_run(tmp_path, None))
    with pytest.raises(CheckpointError, match=r"round-02\.npz is of schema 2.*plan\.json") as told:
        load_checkpoint(path, SPEC)
    assert "\n" not in str(told.value)


@pytest.mark.parametrize("plan", [{}, {"gate": 3}, {"gate": {"hunch": 1}}, [], "{"])
def test_a_plan_that_is_none_is_named(plan, checkpoint, tmp_path):
    path = of_schema_2(checkpoint, in_a_run(tmp_path, plan))
    if plan == "{":
        (tmp_path / "plan.json").write_text("{")
    with pytest.raises(CheckpointError, match=r"does not fit .*plan\.json") as told:
        load_checkpoint(path, SPEC)
    assert "\n" not in str(told.value)
