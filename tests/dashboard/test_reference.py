"""What a page compares a moment with: the states that the gate was fitted to, and their images."""

from dataclasses import replace

import numpy as np
import pytest

from sheath_manip.dashboard.reference import GateReference
from sheath_manip.gates.config import GateConfig, planned_signal
from sheath_manip.gates.fitted import FittedGate
from sheath_manip.signals import make_signal
from tests.blobs import fitted_policy, held_out, observation_of, training
from tests.looks import fitted_signal, measures_of

CONFIG = GateConfig(embedding="pixels", precedent_embedding="pixels")


def reference_of(signal: str) -> GateReference:
    policy, states = fitted_policy("hog-svm"), training()
    config = replace(CONFIG, signal=signal)
    fitted = fitted_signal(make_signal(planned_signal(config)), policy, states)
    fitted.calibrate([measures_of(fitted, policy, held_out())])
    return GateReference(FittedGate(config, policy, fitted), states)


@pytest.mark.parametrize("signal", ["joined", "near-joined", "trust"])
def test_a_training_state_is_most_like_itself(signal: str) -> None:
    reference, states = reference_of(signal), training()
    place = 7
    proposed = states.labels[place].astype(np.float32)
    found = reference.precedents(observation_of(states, place), proposed)
    assert found is not None
    assert found.distances[0] < 1e-3
    image = reference.image(found, 0)
    assert image is not None
    (seen,) = states.images.values()
    np.testing.assert_array_equal(image, seen[found.indices[0]])
    np.testing.assert_allclose(found.labels, states.labels[found.indices], atol=1e-5)
    np.testing.assert_allclose(found.proposed, proposed)
    assert (np.diff(found.distances) >= 0).all()


def test_what_cannot_be_shown_is_said() -> None:
    reference, states = reference_of("joined"), training()
    observation, proposed = observation_of(states, 0), states.labels[0].astype(np.float32)
    found = reference.precedents(observation, proposed)
    assert found is not None
    others = replace(reference, states=states.take(np.arange(9)))
    assert others.image(found, 0) is None
    assert others.lacks_of(found).startswith("No images: the store has 9 labelled states")
    untold = replace(reference, states=None, lacks="No images.")
    assert (untold.image(found, 0), untold.lacks_of(found)) == (None, "No images.")
    assert reference_of("support").precedents(observation, proposed) is None
