"""A dimension of the action with one admissible value is learned, judged and compared as any."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from sheath_manip.policies import make_policy
from sheath_manip.policies.deviation import largest_deviations
from sheath_manip.policies.features import Features
from sheath_manip.signals.near_precedent import NearPrecedentSignal
from sheath_manip.types import ActionSpec, TaskSpec
from sheath_manip.types.samples import Samples
from sheath_manip.types.seen import Seen
from tests import line, reach

FIXED = 40.0
"""large beside the others, so that its squares would swallow theirs"""


def with_fixed(spec: TaskSpec) -> TaskSpec:
    """The task with a third dimension that has one value."""
    action = spec.action
    bounds = (np.append(bound, np.float32(FIXED)) for bound in (action.minimum, action.maximum))
    return replace(spec, action=ActionSpec((*action.names, "gripper"), *bounds, tolerance=0.1))


def labelled(samples: Samples) -> Samples:
    fixed = np.full((len(samples), 1), FIXED, np.float32)
    return replace(samples, labels=np.concatenate([samples.labels, fixed], axis=1))


@pytest.mark.parametrize("name", ["spatial-cnn", "egocentric-cnn"])
def test_a_regressor_gives_the_one_value_and_loses_nothing_by_it(name):
    toy = reach if name == "spatial-cnn" else line
    quick = {"steps": 4, "warm_steps": 2}
    settings = (
        {**toy.SETTINGS, **quick}
        if toy is reach
        else {**toy.SETTINGS, "spatial_settings": toy.SETTINGS["spatial_settings"] | quick}
    )
    samples = labelled(toy.training().take(np.arange(60)))
    policy = make_policy(name, with_fixed(toy.SPEC), **settings).fit(samples)
    proposal = policy.predict(samples.observations)
    assert np.isfinite(proposal.now).all()
    np.testing.assert_array_equal(proposal.now[:, 2], FIXED)
    losses = policy.surrogate_losses(proposal, samples.labels)
    others = largest_deviations(toy.SPEC.action, proposal.now[:, :2], samples.labels[:, :2])
    np.testing.assert_array_equal(losses, others)


def test_near_precedent_compares_the_others_as_if_there_were_none():
    samples, new = reach.training().take(np.arange(60)), reach.held_out().take(np.arange(20))

    def scores(spec: TaskSpec, of: Callable[[Samples], Samples]) -> np.ndarray:
        signal = NearPrecedentSignal(Features())
        signal.attach(make_policy("spatial-cnn", spec))
        signal.fit(of(samples).labels, Seen(samples.features, of(samples).labels, {}))
        return signal.score(Seen(new.features, of(new).labels, {}))

    np.testing.assert_allclose(
        scores(with_fixed(reach.SPEC), labelled), scores(reach.SPEC, lambda of: of), atol=1e-2
    )
