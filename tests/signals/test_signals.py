"""What every signal must do, and what joining them does."""

from dataclasses import replace

import numpy as np
import pytest

from sheath_manip.exceptions import ParameterError, UnknownNameError
from sheath_manip.gates.config import GateConfig, planned_signal
from sheath_manip.policies import make_embedding
from sheath_manip.protocols import Signal
from sheath_manip.signals import SIGNALS, make_signal
from sheath_manip.signals.joined import JoinedSignal, log_share
from sheath_manip.signals.margin import MarginSignal
from sheath_manip.signals.precedent import PrecedentSignal
from sheath_manip.signals.trust import TrustSignal
from tests.blobs import CHOICES, fitted_policy, held_out, observation_of, training
from tests.feature_signal import FeatureSignal

GATE = GateConfig(embedding="pixels", precedent_embedding="pixels")


def fitted(name: str) -> Signal:
    choice = planned_signal(replace(GATE, signal=name))
    return make_signal(choice).fit(fitted_policy("hog-svm"), training()).calibrate([held_out()])


@pytest.fixture(scope="module", params=SIGNALS)
def signal(request) -> Signal:
    return fitted(request.param)


def scores_of(signal: Signal, samples) -> np.ndarray:
    return signal.scores(samples.images, samples.features)


def test_there_is_a_score_for_each_state_and_none_for_none(signal):
    samples = held_out()
    scores = scores_of(signal, samples)
    assert scores.shape == (len(samples),)
    assert scores.dtype == np.float64
    assert np.isfinite(scores).all()


@pytest.mark.parametrize("name", SIGNALS)
def test_fits_and_scores_repeat_to_the_bit(name):
    signal = fitted(name)
    again = fitted(name)
    np.testing.assert_array_equal(scores_of(again, held_out()), scores_of(signal, held_out()))


@pytest.mark.parametrize("name", SIGNALS)
def test_what_is_loaded_scores_as_what_was_saved(name):
    signal = fitted(name)
    fresh = make_signal(planned_signal(replace(GATE, signal=name)))
    loaded = fresh.load(fitted_policy("hog-svm"), signal.arrays())
    np.testing.assert_array_equal(scores_of(loaded, held_out()), scores_of(signal, held_out()))


def test_another_world_scores_below_the_own(signal):
    samples = held_out()
    noise = np.random.default_rng(0).integers(0, 255, samples.images["top"].shape, dtype=np.uint8)
    other = signal.scores({"top": noise}, samples.features)
    assert np.median(other) < np.quantile(scores_of(signal, samples), 0.01)


def test_an_unknown_name_is_told():
    with pytest.raises(UnknownNameError, match=r"signal 'hunch'.*joined"):
        make_signal(planned_signal(replace(GATE, signal="hunch")))


class Stubborn:
    """A policy that always proposes the same."""

    def __init__(self, action: np.ndarray) -> None:
        self.action = action

    def predict(self, images, features):
        del images
        return np.repeat(self.action[None], len(features), axis=0)


def test_a_precedent_is_a_state_with_the_same_label():
    samples = training()
    right = samples.labels[:, 0] > 0
    policy = Stubborn(CHOICES[2])
    signal = PrecedentSignal(make_embedding("pixels")).fit(policy, samples)  # pyright: ignore[reportArgumentType]
    scores = scores_of(signal, samples)
    # On a training state labelled so the distance is 0; float32 sums leave a little.
    assert np.abs(scores[right]).max() < 0.05
    assert scores[~right].max() < np.quantile(scores[right], 0)
    observation = observation_of(samples, int(np.flatnonzero(right)[0]))
    image = observation.images["top"][None]
    assert signal.scores({"top": image}, observation.features[None])[0] == pytest.approx(0, abs=0.1)


def test_without_any_precedent_the_score_is_minus_infinity_and_a_nan_has_none():
    signal = PrecedentSignal(make_embedding("pixels"), tolerance=0.0)
    ahead_only = training().take(training().labels[:, 0] == 0)
    for action, expected in ((CHOICES[2], -np.inf), (np.array([np.nan], np.float32), np.nan)):
        signal.fit(Stubborn(action), ahead_only)  # pyright: ignore[reportArgumentType]
        np.testing.assert_array_equal(scores_of(signal, held_out()), np.full(200, expected))
    with pytest.raises(ParameterError, match="tolerance is 1"):
        PrecedentSignal(make_embedding("pixels"), tolerance=1.0)


class OnFeatures:
    """An embedding that is the features."""

    def fit(self, policy, samples):
        del policy, samples
        return self

    def transform(self, images, features):
        del images
        return np.asarray(features, np.float32)


def trust_at(place: float, placed: dict[float, np.ndarray], **settings: int) -> float:
    """Of proposing CHOICES[2] at `place`, among training states on a line by place and label."""
    states = training().take(np.arange(len(placed)))
    places = np.array([list(placed)], np.float32).T
    states = replace(states, features=places, labels=np.array(list(placed.values())))
    signal = TrustSignal(OnFeatures(), **settings).fit(Stubborn(CHOICES[2]), states)  # pyright: ignore[reportArgumentType]
    return float(signal.scores({}, np.array([[place]], np.float32))[0])


def test_a_proposal_is_trusted_by_its_precedents_against_the_nearest_objection():
    yes, no = CHOICES[2], CHOICES[0]
    line = {-3.0: yes, -2.0: yes, -1.0: yes, 4.0: no, 5.0: no}
    # The second precedent is 2 away, the objection 4: (4 - 2) / (4 + 2), less the resolution.
    assert trust_at(0.0, line) == pytest.approx(1 / 3, abs=0.01)
    assert trust_at(0.0, line, precedents=1) == pytest.approx(3 / 5, abs=0.01)
    assert trust_at(-2.0, line) > trust_at(0.0, line) > trust_at(2.0, line)
    # One objection where a lone precedent lies as well: neither has the better of it.
    assert abs(trust_at(0.0, {0.0: yes, 1e-4: no, 9.0: yes}, precedents=1)) < 0.01
    assert trust_at(0.0, {0.0: yes, 1e-4: no, 9.0: yes}, precedents=2) < -0.9


def test_trust_without_precedents_or_without_objections():
    yes, no = CHOICES[2], CHOICES[0]
    assert trust_at(0.0, {0.0: yes, 1.0: yes}) == 1.0
    assert trust_at(0.0, {0.0: yes, 1.0: no, 2.0: no}) == -1.0
    assert trust_at(0.0, {0.0: yes}) == -1.0
    assert np.isnan(trust_at(np.nan, {0.0: yes, 1.0: yes, 2.0: no}))
    with pytest.raises(ParameterError, match="precedents is 0"):
        TrustSignal(make_embedding("pixels"), precedents=0)


def test_a_margin_is_by_how_much_the_best_choice_beats_the_second():
    class Ranking(Stubborn):
        def choice_scores(self, images, features):
            del images
            return np.asarray(features)

    with pytest.raises(ParameterError, match="Stubborn does not score its choices"):
        MarginSignal().fit(Stubborn(CHOICES[0]), training())  # pyright: ignore[reportArgumentType]
    # isinstance looks for all methods of a policy, of which this one has but two.
    signal = MarginSignal()
    signal.policy = Ranking(CHOICES[0])  # pyright: ignore[reportAttributeAccessIssue]
    scores = np.array([[1.0, 3.0, 2.5], [0.0, -np.inf, -np.inf], [2.0, 2.0, 0.0]])
    np.testing.assert_array_equal(signal.scores({}, scores), [0.5, np.inf, 0.0])


def test_the_share_falls_with_the_score_and_on_below_all_that_was_seen():
    reference = np.sort(np.random.default_rng(0).normal(size=1000))
    scores = np.linspace(-20, 4, 400)
    logs = log_share(scores, reference)
    assert (np.diff(logs) >= 0).all()
    assert (np.diff(logs[scores < reference[0]]) > 0).all()
    assert logs[-1] == pytest.approx(0, abs=0.01)
    assert np.isnan(log_share(np.array([np.nan]), reference)).all()
    assert log_share(np.array([-np.inf]), reference)[0] == -np.inf
    # A tenth of the expert's own steps lie below this one.
    tenth = log_share(np.array([np.quantile(reference, 0.1)]), reference)
    assert tenth[0] == pytest.approx(np.log(0.1), abs=0.02)


def test_joined_one_veto_suffices_and_two_suspicions_add_up():
    rng = np.random.default_rng(0)
    features = rng.normal(size=(2000, 2)).astype(np.float32)
    samples = replace(held_out(), features=features, images={})
    joined = JoinedSignal({"first": FeatureSignal(0), "second": FeatureSignal(1)})  # pyright: ignore[reportArgumentType]
    joined.calibrate([samples])

    def score(*values: float) -> float:
        return float(joined.scores({}, np.array([values], np.float32))[0])

    usual = joined.scores({}, features)
    assert score(-30.0, 3.0) < usual.min()
    assert score(-1.5, -1.5) < score(-1.5, 0.0) < score(0.0, 0.0)
    assert np.isnan(score(np.nan, 0.0))
    assert score(-np.inf, 0.0) == -np.inf


def test_a_weight_is_how_often_a_signal_counts():
    rng = np.random.default_rng(0)
    features = rng.normal(size=(500, 2)).astype(np.float32)
    samples = replace(held_out(), features=features, images={})

    def scores(*columns: int, **weights: float) -> np.ndarray:
        signals = {f"s{number}": FeatureSignal(column) for number, column in enumerate(columns)}
        joined = JoinedSignal(signals, weights or None)  # pyright: ignore[reportArgumentType]
        return joined.calibrate([samples]).scores({}, features)

    np.testing.assert_allclose(scores(0, 1, s0=1.0, s1=2.0), scores(0, 1, 1))


def test_what_cannot_be_joined():
    two = {"a": FeatureSignal(0), "b": FeatureSignal(1)}
    for weights in ({"a": 1.0}, {"a": 1.0, "b": 0.0}):
        with pytest.raises(ParameterError, match="wanted one above 0 each"):
            JoinedSignal(two, weights)  # pyright: ignore[reportArgumentType]
    with pytest.raises(ParameterError, match="wanted at least 2"):
        JoinedSignal({"one": FeatureSignal(0)})  # pyright: ignore[reportArgumentType]
    nothing = replace(held_out(), features=np.full((50, 2), np.nan, np.float32), images={})
    joined = JoinedSignal({"a": FeatureSignal(0), "b": FeatureSignal(1)})  # pyright: ignore[reportArgumentType]
    with pytest.raises(ParameterError, match=r"signal 'a' scores 0 steps of 1 .* at least 20"):
        joined.calibrate([nothing])
