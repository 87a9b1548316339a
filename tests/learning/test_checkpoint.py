import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sheath_manip.exceptions import CheckpointError, ParameterError
from sheath_manip.gates.config import GateConfig, planned_signal
from sheath_manip.gates.fitted import FittedGate, Sources
from sheath_manip.gates.held_out import HeldOut
from sheath_manip.gates.human import HumanGate, Nobody
from sheath_manip.gates.support import SupportGate
from sheath_manip.learning.checkpoint import Checkpoint, digest, load_checkpoint
from sheath_manip.learning.checkpoint_file import read_arrays, write_arrays
from sheath_manip.policies import make_policy
from sheath_manip.protocols import TrainablePolicy
from sheath_manip.signals import make_signal
from sheath_manip.support.config import SupportConfig
from sheath_manip.types import Judgement, Observation, Reason
from sheath_manip.types.samples import Samples
from tests import buttons
from tests.blobs import CHOICES, SPEC, fitted_policy, held_out, observation_of, training
from tests.looks import fitted_signal, measures_of

CONFIG = GateConfig(
    signal="support",
    embedding="pixels",
    precedent_embedding="pixels",
    support=SupportConfig(nu=0.1, bandwidth_factor=0.5),
    release_margin=0.02,
    quiet_steps=1,
    minimum_hold_steps=3,
    labels="own",
)
GATE = CONFIG.described()
HELD_OUT = HeldOut.of([np.array([0.5, np.nan, -0.25]), np.array([0.1])])


def fitted_to(
    config: GateConfig, policy: TrainablePolicy, states: Samples, usual: Samples
) -> FittedGate:
    signal = fitted_signal(make_signal(planned_signal(config)), policy, states)
    signal.calibrate([measures_of(signal, policy, usual)])
    sources = Sources(("expert-0",), ("expert-1", "expert-2"))
    return FittedGate(config, policy, signal, -0.01, 0.005, sources, held_out=HELD_OUT)


def checkpoint_of(policy_name: str, embedding_name: str, signal: str = "support") -> Checkpoint:
    policy = fitted_policy(policy_name)
    config = replace(
        CONFIG, signal=signal, embedding=embedding_name, precedent_embedding=embedding_name
    )
    return Checkpoint(
        task=SPEC.name,
        policy_name=policy_name,
        policy=policy,
        fitted=fitted_to(config, policy, training(), held_out()),
        method="sheath",
        round=3,
        run_seed=1,
        training_loss=0.25,
    )


def judged(gate: FittedGate, observation: Observation) -> Judgement:
    return gate.judge(observation, gate.policy.propose(observation.alone), np.inf)


@pytest.fixture(scope="module")
def checkpoint() -> Checkpoint:
    return checkpoint_of("cnn", "pooled-convolutions")


@pytest.fixture
def path(checkpoint, tmp_path) -> Path:
    return checkpoint.save(tmp_path / "deep" / "round-03.npz")


def rewritten(path: Path, **changes) -> Path:
    """The same file with another header, and the digest that belongs to it."""
    header, arrays = read_arrays(path)
    del header["digest"]
    with path.open("wb") as file:
        write_arrays(file, header | changes, arrays)
    return path


@pytest.mark.parametrize(
    ("policy", "embedding", "signal"),
    [
        pytest.param("cnn", "two-scale-convolutions", "support", marks=pytest.mark.soak),
        pytest.param(
            "paper-cnn", "pooled-convolutions-whitened", "support", marks=pytest.mark.soak
        ),
        ("paper-cnn", "penultimate", "precedent"),
        ("hog-svm", "pixels", "joined"),
        ("hog-svm", "pixels", "trust-joined"),
    ],
)
def test_what_is_loaded_is_what_was_saved(policy, embedding, signal, tmp_path):
    saved = checkpoint_of(policy, embedding, signal)
    loaded = load_checkpoint(saved.save(tmp_path / "round.npz"), SPEC)
    samples = held_out()
    np.testing.assert_array_equal(loaded.fitted.scores(samples), saved.fitted.scores(samples))
    np.testing.assert_array_equal(
        loaded.policy.propose(samples.observations).actions,
        saved.policy.propose(samples.observations).actions,
    )
    parts = {"policy": None, "fitted": None}
    assert {**vars(loaded), **parts} == {**vars(saved), **parts}
    parts = {"policy": None, "signal": None, "held_out": None, "_parts": None}
    for kept, was in zip(loaded.fitted.held_out.episodes, HELD_OUT.episodes, strict=True):
        np.testing.assert_array_equal(kept, was)
    assert {**vars(loaded.fitted), **parts} == {**vars(saved.fitted), **parts}
    assert loaded.fitted.policy is loaded.policy


def test_one_score_is_that_of_the_batch(checkpoint):
    samples = held_out()
    scores = checkpoint.fitted.scores(samples)
    for index in range(5):
        score = judged(checkpoint.fitted, observation_of(samples, index)).score
        assert isinstance(score, float)
        assert score == pytest.approx(scores[index], abs=1e-5)


def test_its_gate_has_the_settings_that_it_was_trained_with(path):
    gate = load_checkpoint(path, SPEC).gate()
    assert isinstance(gate, SupportGate)
    assert (gate.threshold, gate.query) == (-0.01, False)
    # What was calibrated, and what is asked for on top.
    assert gate.release_margin == pytest.approx(0.005 + 0.02)
    assert (gate.quiet_steps, gate.minimum_hold_steps) == (1, 3)


def test_where_a_schedule_or_a_person_decides_nothing_is_fitted_and_nothing_scores(
    checkpoint, tmp_path
):
    for kind in ("expert", "mixture", "random-takeover", "human"):
        config = replace(CONFIG, kind=kind)
        saved = replace(checkpoint, fitted=FittedGate(config, checkpoint.policy))
        loaded = load_checkpoint(saved.save(tmp_path / f"{kind}.npz"), SPEC)
        assert loaded.fitted.signal is None
        assert np.isnan(loaded.threshold)
        loaded.gate()
        with pytest.raises(ParameterError, match=f"kind '{kind}' looks at no signal"):
            loaded.fitted.scores(held_out())
    human = load_checkpoint(tmp_path / "human.npz", SPEC).gate()
    assert isinstance(human, HumanGate)
    assert isinstance(human.person, Nobody)


def test_the_digest_is_that_of_the_content(checkpoint, path, tmp_path):
    again = checkpoint.save(tmp_path / "again.npz")
    reloaded = load_checkpoint(path, SPEC).save(tmp_path / "reloaded.npz")
    assert digest(path) == digest(again) == digest(reloaded)
    assert len(digest(path)) == 16
    other = checkpoint.with_threshold(0.0).save(tmp_path / "other.npz")
    assert digest(other) != digest(path)
    with pytest.raises(CheckpointError, match="cannot read"):
        digest(tmp_path / "missing.npz")


def test_binary_features_take_a_tenth_of_their_bytes(checkpoint, tmp_path):
    states = buttons.button_samples(2000, seed=0)
    policy = make_policy("linear-svm", buttons.SPEC, penalty=0.1).fit(states)
    config = GateConfig(
        embedding="features", precedent_embedding="features", support=SupportConfig(nu=0.5)
    )
    saved = replace(
        checkpoint,
        task=buttons.SPEC.name,
        policy_name="linear-svm",
        policy=policy,
        fitted=fitted_to(config, policy, states, states),
    )
    path = saved.save(tmp_path / "round.npz")
    assert path.stat().st_size < 0.1 * states.features.nbytes
    loaded = load_checkpoint(path, buttons.SPEC)
    np.testing.assert_array_equal(loaded.fitted.scores(states), saved.fitted.scores(states))


def test_a_save_that_fails_leaves_the_old_file_and_no_litter(checkpoint, path, monkeypatch):
    before = path.read_bytes()

    def full_disk(_):
        raise OSError("no space left on device")

    monkeypatch.setattr("sheath_manip.files.outputs.os.fsync", full_disk)
    with pytest.raises(OSError, match="no space"):
        replace(checkpoint, round=4).save(path)
    assert path.read_bytes() == before
    assert list(path.parent.iterdir()) == [path]


@pytest.mark.parametrize("content", [b"", b"not a checkpoint", b"PK\x03\x04 cut short", None])
def test_broken_files_are_named_in_one_line(content, path):
    path.write_bytes(path.read_bytes()[:5000] if content is None else content)
    with pytest.raises(CheckpointError, match=r"round-03\.npz") as caught:
        load_checkpoint(path, SPEC)
    assert "\n" not in str(caught.value)


def test_a_flipped_byte_is_noticed(path):
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 0xFF
    path.write_bytes(bytes(content))
    with pytest.raises(CheckpointError):
        load_checkpoint(path, SPEC)


def test_missing_foreign_and_pickled_files(tmp_path):
    with pytest.raises(CheckpointError, match="no checkpoint at"):
        load_checkpoint(tmp_path / "missing.npz", SPEC)
    foreign = tmp_path / "foreign.npz"
    np.savez(foreign, weights=np.zeros(3))
    with pytest.raises(CheckpointError, match="is no checkpoint"):
        load_checkpoint(foreign, SPEC)
    np.save(tmp_path / "one.npy", np.zeros(3))
    with pytest.raises(CheckpointError, match="read"):
        load_checkpoint(tmp_path / "one.npy", SPEC)
    np.savez(foreign, header=np.array({"format": "sheath-checkpoint"}, dtype=object))
    with pytest.raises(CheckpointError, match="wanted booleans, numbers"):
        load_checkpoint(foreign, SPEC)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"format": "another"}, "is no checkpoint"),
        ({"schema": 99}, "has schema 99"),
        ({"task": "grasp"}, "trained on task 'grasp'"),
        ({"policy": {"name": "oracle", "hyper": {}}}, "unknown policy 'oracle'"),
        ({"gate": GATE | {"embedding": "clip"}}, "unknown embedding 'clip'"),
        ({"gate": GATE | {"support": {"name": "knn"}}}, "unknown support estimator 'knn'"),
        ({"gate": GATE | {"support": {"mu": 1}}}, "is no config of a gate"),
        ({"gate": GATE | {"signal": "hunch"}}, "unknown signal 'hunch'"),
        ({"gate": GATE | {"labels": "some"}}, "labels is 'some'; wanted all, own, drawn"),
        ({"gate": GATE | {"mu": 1}}, "is no config of a gate"),
        ({"sources": None}, "broken"),
        ({"policy": {}}, "broken"),
        ({"round": None}, "broken"),
    ],
)
def test_headers_that_do_not_fit(changes, message, path):
    with pytest.raises(CheckpointError, match=message) as caught:
        load_checkpoint(rewritten(path, **changes), SPEC)
    assert "\n" not in str(caught.value)


def test_what_changed_since_it_was_written_is_found(path):
    header, arrays = read_arrays(path)
    name = next(name for name in arrays if name.startswith("signal/"))
    changed = {**arrays, name: arrays[name] + 1}
    for written, among in ((header, changed), ({**header, "threshold": 0.5}, arrays)):
        np.savez(path, allow_pickle=False, header=np.array(json.dumps(written)), **among)
        with pytest.raises(CheckpointError, match="is not what was written"):
            load_checkpoint(path, SPEC)


def test_a_file_of_before_there_were_digests_is_read_and_told(checkpoint, path):
    header, arrays = read_arrays(path)
    del header["digest"]
    old = np.array(json.dumps({**header, "schema": 3}))
    np.savez(path, allow_pickle=False, header=old, **arrays)
    loaded = load_checkpoint(path, SPEC)
    assert "has no digest: an older version wrote it" in loaded.remark
    assert loaded.threshold == checkpoint.threshold
    assert load_checkpoint(checkpoint.save(path), SPEC).remark == ""


def test_a_fit_to_what_is_no_number_is_not_saved(checkpoint, tmp_path):
    arrays = dict(checkpoint.policy.arrays())
    arrays["head.bias"] = np.full_like(arrays["head.bias"], np.nan)
    broken = make_policy("cnn", SPEC).load(arrays)
    assert np.isnan(broken.predict(held_out().observations).actions).all()
    with pytest.raises(CheckpointError, match=r"policy/head.bias\[0\] is nan; wanted finite"):
        replace(checkpoint, policy=broken).save(tmp_path / "nan.npz")
    assert list(tmp_path.iterdir()) == []


def test_no_memory_is_taken_for_what_hyperparameters_ask_for(path):
    header, _ = read_arrays(path)
    policy = {"name": "cnn", "hyper": {**header["policy"]["hyper"], "hidden": [10**9, 10**9]}}
    with pytest.raises(CheckpointError, match=r"weights are not those of a network .* 1000000000"):
        load_checkpoint(rewritten(path, policy=policy), SPEC)


def test_a_task_with_other_choices(path):
    spec = replace(SPEC, action=replace(SPEC.action, choices=CHOICES[:2]))
    with pytest.raises(CheckpointError, match="does not fit"):
        load_checkpoint(path, spec)


def test_alone_a_support_says_outside_and_what_weighs_the_proposal_says_risk(checkpoint):
    observation = observation_of(held_out(), 0)
    assert judged(checkpoint.fitted, observation).blames is Reason.OUTSIDE
    trust = checkpoint_of("hog-svm", "pixels", "trust").fitted
    assert judged(trust, observation).blames is Reason.RISK
