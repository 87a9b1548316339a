import json
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import pytest

from sheath_manip.exceptions import CheckpointError
from sheath_manip.learning.checkpoint import Checkpoint, digest, load_checkpoint
from sheath_manip.policies import make_policy
from sheath_manip.signals import SignalChoice, make_signal
from sheath_manip.signals.joined import JoinedSignal
from sheath_manip.types import Observation, Reason
from tests import buttons
from tests.blobs import CHOICES, SPEC, fitted_policy, held_out, observation_of, training
from tests.feature_signal import FeatureSignal

CHOICE = asdict(SignalChoice("support", "pixels", "one-class-svm", "pixels"))


def checkpoint_of(policy_name: str, embedding_name: str, signal: str = "support") -> Checkpoint:
    policy = fitted_policy(policy_name)
    hyper = {"nu": 0.1, "bandwidth_factor": 0.5}
    choice = SignalChoice(signal, embedding_name, "one-class-svm", embedding_name, hyper)
    return Checkpoint(
        task=SPEC.name,
        policy_name=policy_name,
        policy=policy,
        signal_choice=choice,
        signal=make_signal(choice).fit(policy, training()).calibrate([held_out()]),
        threshold=-0.01,
        false_alarm_rate=0.05,
        method="sheath",
        round=3,
        run_seed=1,
    )


@pytest.fixture(scope="module")
def checkpoint() -> Checkpoint:
    return checkpoint_of("cnn", "pooled-convolutions")


@pytest.fixture
def path(checkpoint, tmp_path) -> Path:
    return checkpoint.save(tmp_path / "deep" / "round-03.npz")


def rewritten(path: Path, **changes) -> Path:
    """The same file with another header."""
    with np.load(path) as file:
        arrays = dict(file)
    header = json.loads(str(arrays["header"])) | changes
    np.savez(path, allow_pickle=False, **(arrays | {"header": np.array(json.dumps(header))}))
    return path


@pytest.mark.parametrize(
    ("policy", "embedding", "signal"),
    [
        ("cnn", "two-scale-convolutions", "support"),
        ("cnn", "convolutions-and-pixels", "support"),
        ("plain-cnn", "random-convolutions", "support"),
        ("cnn", "pooled-convolutions", "joined"),
        ("paper-cnn", "pooled-convolutions-whitened", "support"),
        ("paper-cnn", "penultimate", "precedent"),
        ("hog-svm", "pixels", "joined"),
        ("hog-svm", "pixels", "trust-joined"),
    ],
)
def test_what_is_loaded_is_what_was_saved(policy, embedding, signal, tmp_path):
    saved = checkpoint_of(policy, embedding, signal)
    loaded = load_checkpoint(saved.save(tmp_path / "round.npz"), SPEC)
    samples = held_out()
    np.testing.assert_array_equal(loaded.scores(samples), saved.scores(samples))
    np.testing.assert_array_equal(
        loaded.policy.predict(samples.images, samples.features),
        saved.policy.predict(samples.images, samples.features),
    )
    parts = {"policy": None, "signal": None}
    assert {**vars(loaded), **parts} == {**vars(saved), **parts}


def test_one_score_is_that_of_the_batch(checkpoint):
    samples = held_out()
    scores = checkpoint.scores(samples)
    for index in range(5):
        score = checkpoint.score(observation_of(samples, index))
        assert isinstance(score, float)
        assert score == pytest.approx(scores[index], abs=1e-5)


def test_the_digest_is_that_of_the_content(checkpoint, path, tmp_path):
    again = checkpoint.save(tmp_path / "again.npz")
    reloaded = load_checkpoint(path, SPEC).save(tmp_path / "reloaded.npz")
    assert digest(path) == digest(again) == digest(reloaded)
    assert len(digest(path)) == 16
    other = replace(checkpoint, threshold=0.0).save(tmp_path / "other.npz")
    assert digest(other) != digest(path)
    with pytest.raises(CheckpointError, match="cannot read"):
        digest(tmp_path / "missing.npz")


def test_binary_features_take_a_tenth_of_their_bytes(checkpoint, tmp_path):
    states = buttons.button_samples(2000, seed=0)
    policy = make_policy("linear-svm", buttons.SPEC, penalty=0.1).fit(states)
    choice = SignalChoice("joined", "features", "one-class-svm", "features", {"nu": 0.5})
    saved = replace(
        checkpoint,
        task=buttons.SPEC.name,
        policy_name="linear-svm",
        policy=policy,
        signal_choice=choice,
        signal=make_signal(choice).fit(policy, states).calibrate([states]),
    )
    path = saved.save(tmp_path / "round.npz")
    assert path.stat().st_size < 0.1 * states.features.nbytes
    loaded = load_checkpoint(path, buttons.SPEC)
    np.testing.assert_array_equal(loaded.scores(states), saved.scores(states))


def test_a_save_that_fails_leaves_the_old_file_and_no_litter(checkpoint, path, monkeypatch):
    before = path.read_bytes()

    def full_disk(_):
        raise OSError("no space left on device")

    monkeypatch.setattr("sheath_manip.learning.checkpoint.os.fsync", full_disk)
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
    with pytest.raises(CheckpointError, match="cannot be read"):
        load_checkpoint(foreign, SPEC)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"format": "another"}, "is no checkpoint"),
        ({"schema": 99}, "has schema 99"),
        ({"task": "grasp"}, "trained on task 'grasp'"),
        ({"policy": {"name": "mlp", "hyper": {}}}, "unknown policy 'mlp'"),
        ({"signal": CHOICE | {"embedding": "clip"}}, "unknown embedding 'clip'"),
        ({"signal": CHOICE | {"support": "knn"}}, "unknown support estimator 'knn'"),
        ({"signal": CHOICE | {"hyperparameters": {"mu": 1}}}, "broken"),
        ({"signal": CHOICE | {"signal": "hunch"}}, "unknown signal 'hunch'"),
        ({"policy": {}}, "broken"),
        ({"round": None}, "broken"),
    ],
)
def test_headers_that_do_not_fit(changes, message, path):
    with pytest.raises(CheckpointError, match=message) as caught:
        load_checkpoint(rewritten(path, **changes), SPEC)
    assert "\n" not in str(caught.value)


def test_a_task_with_other_choices(path):
    spec = replace(SPEC, action=replace(SPEC.action, choices=CHOICES[:2]))
    with pytest.raises(CheckpointError, match="does not fit"):
        load_checkpoint(path, spec)


def test_to_blame_is_the_signal_that_finds_a_state_rarest_however_often_it_counts(checkpoint):
    rng = np.random.default_rng(0)
    usual = replace(held_out(), features=rng.normal(size=(2000, 2)).astype(np.float32), images={})
    signal = JoinedSignal(
        {"support": FeatureSignal(0), "trust": FeatureSignal(1)},  # pyright: ignore[reportArgumentType]
        {"support": 1.0, "trust": 4.0},
    ).calibrate([usual])
    joined = replace(checkpoint, signal=signal)
    for features, reason in (([-6.0, -2.0], Reason.OUTSIDE), ([0.0, -6.0], Reason.RISK)):
        observation = Observation({}, np.array(features, np.float32), 0.0)
        assert joined.reason(observation) is reason


def test_alone_a_support_says_outside_and_what_weighs_the_proposal_says_risk(checkpoint):
    observation = observation_of(held_out(), 0)
    assert checkpoint.reason(observation) is Reason.OUTSIDE
    assert checkpoint_of("hog-svm", "pixels", "trust").reason(observation) is Reason.RISK
