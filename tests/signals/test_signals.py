"""What every signal must do, and what joining them does."""

from dataclasses import replace
from typing import cast

import numpy as np
import pytest
from numpy.typing import ArrayLike

from sheath_manip.exceptions import ParameterError, UnknownNameError
from sheath_manip.policies import make_embedding
from sheath_manip.policies.features import Features
from sheath_manip.policies.looking import look
from sheath_manip.protocols import Refits, Signal, TrainablePolicy
from sheath_manip.signals import SIGNALS, SignalChoice, make_signal
from sheath_manip.signals.joined import JoinedSignal, Reference
from sheath_manip.signals.margin import MarginSignal
from sheath_manip.signals.precedent import PrecedentSignal
from sheath_manip.signals.trust import TrustSignal
from sheath_manip.types import Observations, Proposal, Reason
from sheath_manip.types.seen import Seen
from tests.blobs import CHOICES, fitted_policy, held_out, training
from tests.feature_signal import FeatureSignal
from tests.looks import fitted_signal, measures_of, scores_of


def policy() -> TrainablePolicy:
    return fitted_policy("hog-svm")


def made(name: str) -> Signal:
    return make_signal(SignalChoice(name, "pixels", "one-class-svm", "pixels"))


def fitted(name: str) -> Signal:
    signal = fitted_signal(made(name), policy(), training())
    return signal.calibrate([measures_of(signal, policy(), held_out())])


@pytest.fixture(scope="module", params=SIGNALS)
def signal(request) -> Signal:
    return fitted(request.param)


def test_there_is_a_score_for_each_state_and_none_for_none(signal):
    samples = held_out()
    measures = measures_of(signal, policy(), samples)
    scores = signal.scores(measures)
    assert scores.shape == (len(samples),)
    assert measures.dtype == scores.dtype == np.float64
    assert np.isfinite(scores).all()
    nothing = measures_of(signal, policy(), samples.take(np.arange(0)))
    assert nothing.shape == (0, measures.shape[1])
    assert signal.scores(nothing).shape == (0,)


def test_a_state_alone_is_measured_as_among_others(signal):
    samples = held_out()
    measures = measures_of(signal, policy(), samples)
    alone = measures_of(signal, policy(), samples.take(np.arange(1)))
    np.testing.assert_allclose(alone[0], measures[0], atol=1e-2)
    assert isinstance(signal.blames(alone[0]), Reason)


@pytest.mark.parametrize("name", SIGNALS)
def test_fits_and_scores_repeat_to_the_bit(name):
    signal = fitted(name)
    again = fitted(name)
    np.testing.assert_array_equal(
        scores_of(again, policy(), held_out()), scores_of(signal, policy(), held_out())
    )


@pytest.mark.parametrize("name", SIGNALS)
def test_what_is_loaded_scores_as_what_was_saved(name):
    signal = fitted(name)
    loaded = made(name).load(signal.arrays())
    np.testing.assert_array_equal(
        scores_of(loaded, policy(), held_out()), scores_of(signal, policy(), held_out())
    )


def test_another_world_scores_below_the_own(signal):
    samples = held_out()
    noise = np.random.default_rng(0).integers(0, 255, samples.images["top"].shape, dtype=np.uint8)
    other = scores_of(signal, policy(), replace(samples, images={"top": noise}))
    assert np.median(other) < np.quantile(scores_of(signal, policy(), samples), 0.01)


@pytest.mark.parametrize("name", SIGNALS)
def test_what_is_refitted_to_the_same_states_scores_the_same(name):
    signal = fitted(name)
    if not isinstance(signal, Refits):
        return
    before = scores_of(signal, policy(), held_out())
    signal.refit(look(policy(), training().take(np.arange(50)), signal.attach(policy())))
    assert (scores_of(signal, policy(), held_out()) != before).any()
    signal.refit(look(policy(), training(), signal.attach(policy())))
    np.testing.assert_array_equal(scores_of(signal, policy(), held_out()), before)


def test_an_unknown_name_is_told():
    with pytest.raises(UnknownNameError, match=r"signal 'hunch'.*joined"):
        made("hunch")


class Stubborn:
    """A policy that always proposes the same."""

    def __init__(self, action: np.ndarray) -> None:
        self.action = action

    def predict(self, observations: Observations) -> Proposal:
        return Proposal(np.repeat(self.action[None], len(observations), axis=0))

    def surrogate_losses(self, proposal: Proposal, labels: np.ndarray) -> np.ndarray:
        return (proposal.now != labels).any(axis=1).astype(np.float32)


def stubborn(action: np.ndarray) -> TrainablePolicy:
    return cast(TrainablePolicy, Stubborn(action))


def test_a_precedent_is_a_state_with_the_same_label():
    samples = training()
    right = samples.labels[:, 0] > 0
    rightwards = stubborn(CHOICES[2])
    signal = fitted_signal(PrecedentSignal(make_embedding("pixels")), rightwards, samples)
    scores = scores_of(signal, rightwards, samples)
    # On a training state labelled so the distance is 0; float32 sums leave a little.
    assert np.abs(scores[right]).max() < 0.05
    assert scores[~right].max() < np.quantile(scores[right], 0)
    alone = samples.take(np.flatnonzero(right)[:1])
    assert scores_of(signal, rightwards, alone)[0] == pytest.approx(0, abs=0.1)


def test_without_any_precedent_the_score_is_minus_infinity_and_a_nan_has_none():
    signal = PrecedentSignal(make_embedding("pixels"), tolerance=0.0)
    ahead_only = training().take(training().labels[:, 0] == 0)
    for action, expected in ((CHOICES[2], -np.inf), (np.array([np.nan], np.float32), np.nan)):
        fitted_signal(signal, stubborn(action), ahead_only)
        scores = scores_of(signal, stubborn(action), held_out())
        np.testing.assert_array_equal(scores, np.full(200, expected))
    with pytest.raises(ParameterError, match="tolerance is 1"):
        PrecedentSignal(make_embedding("pixels"), tolerance=1.0)


def trust_at(place: float, placed: dict[float, np.ndarray], **settings: int) -> float:
    """Of proposing CHOICES[2] at `place`, among training states on a line by place and label."""
    states = training().take(np.arange(len(placed)))
    places = np.array([list(placed)], np.float32).T
    states = replace(states, features=places, labels=np.array(list(placed.values())))
    signal = TrustSignal(Features(), **settings)
    fitted_signal(signal, stubborn(CHOICES[2]), states)
    here = replace(states.take(np.arange(1)), features=np.array([[place]], np.float32))
    return float(scores_of(signal, stubborn(CHOICES[2]), here)[0])


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
        def predict(self, observations: Observations) -> Proposal:
            latents = {"choice scores": observations.features}
            return replace(super().predict(observations), latents=latents)

    with pytest.raises(ParameterError, match=r"gives no 'choice scores' .* it gives nothing"):
        scores_of(MarginSignal(), stubborn(CHOICES[0]), training())
    ranking = cast(TrainablePolicy, Ranking(CHOICES[0]))
    ranks = [[1.0, 3.0, 2.5], [0.0, -np.inf, -np.inf], [2.0, 2.0, 0.0]]
    states = replace(training().take(np.arange(3)), features=np.array(ranks, np.float32))
    np.testing.assert_array_equal(scores_of(MarginSignal(), ranking, states), [0.5, np.inf, 0.0])


def test_the_share_falls_with_the_score_and_on_below_all_that_was_seen():
    reference = np.sort(np.random.default_rng(0).normal(size=1000))
    scores = np.linspace(-20, 4, 400)
    logs = Reference.of(reference).log_share(scores)
    assert (np.diff(logs) >= 0).all()
    assert (np.diff(logs[scores < reference[0]]) > 0).all()
    assert logs[-1] == pytest.approx(0, abs=0.01)
    assert np.isnan(Reference.of(reference).log_share(np.array([np.nan]))).all()
    assert Reference.of(reference).log_share(np.array([-np.inf]))[0] == -np.inf
    # A tenth of the expert's own steps lie below this one.
    tenth = Reference.of(reference).log_share(np.array([np.quantile(reference, 0.1)]))
    assert tenth[0] == pytest.approx(np.log(0.1), abs=0.02)


def of_features(features: ArrayLike) -> Seen:
    rows = np.asarray(features, np.float32)
    return Seen(rows, np.zeros((len(rows), 1), np.float32), {})


def test_joined_one_veto_suffices_and_two_suspicions_add_up():
    rng = np.random.default_rng(0)
    joined = JoinedSignal({"first": FeatureSignal(0), "second": FeatureSignal(1)})
    measures = joined.measure(of_features(rng.normal(size=(2000, 2))))
    joined.calibrate([measures[:500], measures[500:]])

    def score(*values: float) -> float:
        return float(joined.scores(joined.measure(of_features([values])))[0])

    usual = joined.scores(measures)
    assert score(-30.0, 3.0) < usual.min()
    assert score(-1.5, -1.5) < score(-1.5, 0.0) < score(0.0, 0.0)
    assert np.isnan(score(np.nan, 0.0))
    assert score(-np.inf, 0.0) == -np.inf


def test_a_weight_is_how_often_a_signal_counts():
    rng = np.random.default_rng(0)
    seen = of_features(rng.normal(size=(500, 2)))

    def scores(*columns: int, **weights: float) -> np.ndarray:
        signals = {f"s{number}": FeatureSignal(column) for number, column in enumerate(columns)}
        joined = JoinedSignal(signals, weights or None)
        measures = joined.measure(seen)
        return joined.calibrate([measures]).scores(measures)

    np.testing.assert_allclose(scores(0, 1, s0=1.0, s1=2.0), scores(0, 1, 1))


def test_what_cannot_be_joined():
    two = {"a": FeatureSignal(0), "b": FeatureSignal(1)}
    for weights in ({"a": 1.0}, {"a": 1.0, "b": 0.0}):
        with pytest.raises(ParameterError, match="wanted one above 0 each"):
            JoinedSignal(two, weights)
    with pytest.raises(ParameterError, match="wanted at least 2"):
        JoinedSignal({"one": FeatureSignal(0)})
    joined = JoinedSignal(two)
    nothing = joined.measure(of_features(np.full((50, 2), np.nan)))
    for episodes in ([nothing], []):
        told = rf"signal 'a' scores 0 steps of {len(episodes)} .* at least 20"
        with pytest.raises(ParameterError, match=told):
            joined.calibrate(episodes)


def test_to_blame_is_the_signal_that_finds_a_state_rarest_however_often_it_counts():
    rng = np.random.default_rng(0)
    joined = JoinedSignal(
        {"support": FeatureSignal(0, Reason.OUTSIDE), "trust": FeatureSignal(1, Reason.RISK)},
        {"support": 1.0, "trust": 4.0},
    )
    joined.calibrate([joined.measure(of_features(rng.normal(size=(2000, 2))))])
    for features, reason in (([-6.0, -2.0], Reason.OUTSIDE), ([0.0, -6.0], Reason.RISK)):
        assert joined.blames(joined.measure(of_features([features]))[0]) is reason


def test_alone_a_support_says_outside_and_what_weighs_the_proposal_says_risk():
    for name in ("support", "precedent", "trust", "near-precedent"):
        reason = Reason.OUTSIDE if name == "support" else Reason.RISK
        assert made(name).blames(np.zeros(1)) is reason
