import numpy as np
import pytest

from sheath_manip.exceptions import ParameterError
from sheath_manip.policies.smile import (
    SmileMixture,
    as_first_member,
    expert_weight,
    member_weights,
)
from sheath_manip.types import Observation, Proposal
from tests.buttons import CHOICES, SPEC, button_samples, held_out


def fitted(*choices: int, alpha: float = 0.3) -> SmileMixture:
    """One policy for each of `choices`, which always says that one."""
    policy = SmileMixture(SPEC, "linear-svm", alpha)
    for choice in choices:
        policy.fit(button_samples(20, seed=choice, choices=(choice,)))
    return policy


@pytest.mark.parametrize("alpha", [0.1, 0.5])
@pytest.mark.parametrize("rounds", [1, 2, 7])
def test_weights_are_the_papers(alpha, rounds):
    """Its recursion: pi_n = pi_(n-1) + α (1 - α)^(n-1) (policy_n - expert)."""
    expert, members = 1.0, []
    for n in range(1, rounds + 1):
        moved = alpha * (1 - alpha) ** (n - 1)
        expert, members = expert - moved, [*members, moved]
    assert expert_weight(alpha, rounds) == pytest.approx(expert)
    np.testing.assert_allclose(member_weights(alpha, rounds) * (1 - expert), members)
    assert member_weights(alpha, rounds).sum() == pytest.approx(1)


def test_acts_as_each_policy_by_its_weight():
    policy = fitted(0, 1, 2)
    policy.reset(np.random.default_rng(0))
    observation = Observation({}, held_out().features[0], 0.0).alone
    acted = np.array([policy.propose(observation).now[0] for _ in range(4000)])
    shares = [(acted == choice).all(axis=1).mean() for choice in CHOICES]
    np.testing.assert_allclose(shares, policy.weights(), atol=0.03)


def test_the_same_generator_draws_the_same():
    policy, observation = fitted(0, 1), Observation({}, held_out().features[0], 0.0).alone

    def drawn(seed: int) -> list[list[float]]:
        policy.reset(np.random.default_rng(seed))
        return [policy.propose(observation).now[0].tolist() for _ in range(30)]

    assert drawn(1) == drawn(1) != drawn(2)


def test_losses_are_expected_ones_and_predictions_the_likeliest():
    policy, samples = fitted(0, 1, 2), button_samples(30, seed=0, choices=(1,))
    proposal = policy.predict(samples.observations)
    expected = policy.surrogate_losses(proposal, samples.labels)
    np.testing.assert_allclose(expected, 1 - policy.weights()[1], rtol=1e-6)
    assert (proposal.now == CHOICES[0]).all()
    # Of an action that was recorded it is its own.
    for choice, loss in ((1, 0.0), (2, 1.0)):
        recorded = Proposal(np.repeat(CHOICES[choice][None], 30, axis=0))
        assert (policy.surrogate_losses(recorded, samples.labels) == loss).all()
    # Two that agree outweigh the first.
    agreeing = fitted(0, 1, 1, alpha=0.1)
    assert (agreeing.predict(samples.observations).now == CHOICES[1]).all()


def test_each_policy_is_fitted_to_its_own_round():
    states = [button_samples(50, seed=seed) for seed in range(2)]
    mixture = SmileMixture(SPEC, "linear-svm-paper").fit(states[0]).fit(states[1])
    alone = SmileMixture(SPEC, "linear-svm-paper").fit(states[1])
    np.testing.assert_allclose(
        mixture.arrays()["1/machines"], alone.arrays()["0/machines"], atol=1e-9
    )


def test_begins_with_a_policy_that_was_fitted_before():
    single = fitted(1).members_[0]
    begun = SmileMixture(SPEC, "linear-svm").load(as_first_member(single.arrays()))
    states = held_out().observations
    np.testing.assert_array_equal(begun.predict(states).now, single.predict(states).now)


def test_what_is_proposed_is_drawn_and_what_is_seen_is_the_mixture_s():
    policy, states = fitted(0, 1, 2), held_out().observations.rows(slice(0, 1))
    predicted = policy.predict(states).latents
    np.testing.assert_allclose(predicted["choice scores"][0], policy.weights(), rtol=1e-6)
    policy.reset(np.random.default_rng(0))
    for _ in range(20):
        proposal = policy.propose(states)
        said = proposal.latents["members"][0]
        assert (said == proposal.now[0]).all(axis=1).sum() == 1
        np.testing.assert_array_equal(proposal.latents["choice scores"], predicted["choice scores"])


@pytest.mark.parametrize("alpha", [0.0, 1.0, float("nan")])
def test_alpha_is_a_share(alpha):
    with pytest.raises(ParameterError, match="alpha"):
        SmileMixture(SPEC, alpha=alpha)
