"""The importable suites, over every member of every table, and over members that break them."""

from functools import partial

import numpy as np
import pytest

from sheath_manip.gates import AlwaysPolicy
from sheath_manip.gates.config import GateConfig, planned_signal
from sheath_manip.gates.fitted import FittedGate
from sheath_manip.gates.making import GATES, make_gate
from sheath_manip.policies import (
    EMBEDDINGS,
    ENCODER_EMBEDDINGS,
    FEATURE_EMBEDDINGS,
    LATENT_EMBEDDINGS,
    MEASURED_EMBEDDINGS,
    POLICIES,
    SPATIAL_EMBEDDINGS,
    TOOL_EMBEDDINGS,
    make_embedding,
    make_policy,
)
from sheath_manip.policies.looking import look, look_to_fit
from sheath_manip.protocols import PredictingPolicy
from sheath_manip.signals import SIGNALS, make_signal
from sheath_manip.support import SUPPORTS, make_support
from sheath_manip.testing import (
    check_embedding,
    check_gate,
    check_policy,
    check_signal,
    check_support,
    check_task,
    drawn_states,
)
from sheath_manip.types import Actor, GateDecision, Observation, Proposal, Reason
from sheath_manip.types.samples import Samples
from tests import blobs, buttons, line, reach, servo
from tests.toy import CORRIDOR

EPOCHS = {"epochs": 1}
STEPS = {"steps": 2, "warm_steps": 1}
SETTINGS = {
    "cnn": EPOCHS,
    "plain-cnn": EPOCHS,
    "paper-cnn": EPOCHS,
    "spatial-cnn": reach.SETTINGS | STEPS,
    "mlp": STEPS,
    "act": reach.ACT_SETTINGS | STEPS,
    "egocentric-cnn": line.SETTINGS
    | {"spatial_settings": line.SETTINGS["spatial_settings"] | STEPS},
}
OF_FEATURES = ("linear-svm", "linear-svm-paper", "smile")
QUICK_SUPPORTS = {"reconstruction": 20, "distillation": 20, "disagreement": 10}


def spec_for(name: str):
    if name in OF_FEATURES:
        return buttons.SPEC
    of_continuous = {
        "spatial-cnn": reach.SPEC,
        "act": reach.SPEC,
        "egocentric-cnn": line.SPEC,
        "mlp": servo.SPEC,
    }
    return of_continuous.get(name, blobs.SPEC)


def policy_and_states(name: str) -> tuple[PredictingPolicy, Samples]:
    """Return what an embedding of that name looks through, and states that it is fitted to."""
    if name in FEATURE_EMBEDDINGS:
        states = buttons.training().take(np.arange(100))
        return make_policy("linear-svm", buttons.SPEC, penalty=0.1).fit(states), states
    if name in MEASURED_EMBEDDINGS:
        return servo.fitted_policy(), servo.training().take(np.arange(100))
    if name in SPATIAL_EMBEDDINGS:
        return reach.fitted_policy(), reach.training().take(np.arange(100))
    if name in TOOL_EMBEDDINGS:
        return line.fitted_policy(), line.training().take(np.arange(100))
    if name in LATENT_EMBEDDINGS | ENCODER_EMBEDDINGS:
        return blobs.hidden_layer(), blobs.training().take(np.arange(100))
    return blobs.fitted_policy("cnn"), blobs.training().take(np.arange(100))


@pytest.mark.parametrize("name", sorted(POLICIES))
def test_every_policy_passes(name):
    make = partial(POLICIES[name], **SETTINGS.get(name, {}))
    check_policy(make, spec_for(name), drawn_states(spec_for(name), 40))


@pytest.mark.parametrize("name", sorted(EMBEDDINGS))
def test_every_embedding_passes(name):
    check_embedding(partial(make_embedding, name), *policy_and_states(name))


@pytest.mark.parametrize("name", sorted(SUPPORTS))
def test_every_support_passes(name):
    steps = {"steps": QUICK_SUPPORTS[name]} if name in QUICK_SUPPORTS else {}
    check_support(partial(make_support, name, **steps))


@pytest.mark.parametrize("name", sorted(SIGNALS))
def test_every_signal_passes(name):
    near = name.startswith("near")
    policy = reach.fitted_policy() if near else blobs.fitted_policy("hog-svm")
    states = (reach if near else blobs).training().take(np.arange(100))
    config = GateConfig(signal=name, embedding="pixels", precedent_embedding="pixels")
    check_signal(partial(make_signal, planned_signal(config)), policy, states)


@pytest.mark.parametrize("name", sorted(GATES))
def test_every_gate_passes(name):
    policy, states = blobs.fitted_policy("hog-svm"), blobs.training().take(np.arange(100))
    config = GateConfig(kind=name, signal="support", embedding="pixels", expert_share=0.4)
    signal = make_signal(planned_signal(config))
    signal.fit(states.labels, look_to_fit(policy, states, signal))
    measures = signal.measure(look(policy, states, signal.attach(policy)))
    threshold = float(np.median(signal.calibrate([measures] * 3).scores(measures)))
    fitted = FittedGate(config, policy, signal, threshold)
    rows = [states.observations.rows(slice(i, i + 1)) for i in range(20)]
    seen = [Observation({c: i[0] for c, i in r.images.items()}, r.features[0], 0.0) for r in rows]
    check_gate(partial(make_gate, fitted), seen, [policy.predict(row) for row in rows])


def test_the_toy_task_passes():
    check_task(CORRIDOR)


class Forgetful(AlwaysPolicy):
    """A gate that gets tired of the policy, and does not forget that."""

    asked = 0

    def decide(self, observation: Observation, proposal: Proposal | None) -> GateDecision:
        del observation, proposal
        self.asked += 1
        actor = Actor.POLICY if self.asked < 8 else Actor.HOLD
        return GateDecision(actor, False, Reason.FIXED)


def test_what_breaks_a_contract_is_told_in_a_sentence():
    seen = [Observation({}, np.zeros(1, np.float32), 0.0)] * 5
    proposals = [Proposal(np.zeros((1, 1), np.float32))] * 5
    with pytest.raises(AssertionError, match="reset must forget the last episode"):
        check_gate(Forgetful, seen, proposals)

    class Backwards(SUPPORTS["neighbors"]):  # pyright: ignore
        def decision_function(self, X):
            return -super().decision_function(X)

    with pytest.raises(AssertionError, match=r"must lie inside|must score below 0"):
        check_support(Backwards)

    class Sloppy(POLICIES["linear-svm"]):  # pyright: ignore
        def fit(self, samples):
            super().fit(samples)

    with pytest.raises(AssertionError, match=r"^it has a method `fit`.*: fit must return"):
        check_policy(Sloppy, buttons.SPEC)


def test_a_plain_policy_with_a_method_fit_is_told_why_more_is_wanted():
    class Plain:
        def __init__(self, spec, seed=0):
            self.spec, self.seed = spec, seed

        def fit(self, epochs):
            self.epochs = epochs

        def reset(self, rng):
            self.rng = rng

        def propose(self, observations):
            return Proposal(np.zeros((len(observations), 1), np.float32))

    said = r"^it has a method `fit`, so it is held to TrainablePolicy: Plain lacks predict, "
    with pytest.raises(AssertionError, match=said):
        check_policy(Plain, buttons.SPEC)
