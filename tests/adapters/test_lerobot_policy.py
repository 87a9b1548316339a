"""A plan of LeRobot's is made once a chunk, proposed step by step, and void when others act."""

import numpy as np
import pytest

from sheath_manip.protocols import Replans
from sheath_manip.testing import check_policy
from sheath_manip.types import Proposal
from tests.adapters.lerobot_stand_in import SPEC, CountingChunks, observations, policy_of


def driven(policy, count, seed=3):
    policy.reset(np.random.default_rng(seed))
    seen = observations(count)
    return [policy.propose(seen.rows(slice(row, row + 1))) for row in range(count)]


def test_it_is_a_policy_of_ours():
    check_policy(lambda *_, **__: policy_of(CountingChunks()), SPEC)
    assert isinstance(policy_of(CountingChunks()), Replans)


def test_one_look_a_chunk_and_what_is_left_of_it_is_proposed():
    chunks = CountingChunks(length=4)
    proposals = driven(policy_of(chunks, bounded=False), 10)
    assert [each.actions.shape for each in proposals] == [
        (1, left, 2) for left in (4, 3, 2, 1, 4, 3, 2, 1, 4, 3)
    ]
    assert len(chunks.looks) == 3
    for row, proposal in enumerate(proposals):
        planned_at = observations(10).features[row - row % 4, 0]
        wanted = 2 * (planned_at + np.float32(row % 4) / 10)
        assert np.allclose(proposal.now, wanted, atol=1e-6)


def test_a_void_plan_is_made_anew_and_the_past_is_kept():
    chunks = CountingChunks(length=4, history=3)
    policy = policy_of(chunks)
    policy.reset(np.random.default_rng(0))
    seen = observations(3)
    for row in range(3):
        policy.propose(seen.rows(slice(row, row + 1)))
        policy.replan()
    first = [float(value) for value in seen.features[:, 0]]
    # Before the first step all looked as in it.
    assert chunks.looks == [[first[0]] * 3, [first[0], first[0], first[1]], first]


def test_what_is_drawn_follows_from_the_episodes_generator():
    def seeds(seed):
        chunks = CountingChunks()
        policy = policy_of(chunks)
        driven(policy, 9, seed)
        driven(policy, 9, seed)
        assert chunks.seeds[:3] == chunks.seeds[3:]
        return chunks.seeds[:3]

    assert len({*seeds(1), *seeds(2)}) == 6


def test_actions_are_kept_within_bounds_only_where_they_are_known():
    assert all((np.abs(each.actions) <= 1).all() for each in driven(policy_of(CountingChunks()), 9))
    loose = driven(policy_of(CountingChunks(), bounded=False), 9)
    assert any((np.abs(each.actions) > 1).any() for each in loose)


def test_a_look_at_many_states_keeps_nothing():
    chunks = CountingChunks(length=4, history=2)
    policy = policy_of(chunks)
    before = driven(policy, 2)
    predicted = policy.predict(observations(7))
    assert predicted.actions.shape == (7, 4, 2)
    assert not predicted.latents
    assert np.array_equal(predicted.actions, policy.predict(observations(7)).actions)
    left = policy.propose(observations(1))
    assert np.array_equal(left.actions, before[-1].actions[:, 1:])


def test_losses_are_shares_of_the_range():
    policy = policy_of(CountingChunks())
    proposal = Proposal(np.array([[[0.0, 0.0]], [[1.0, 0.5]]], np.float32))
    labels = np.array([[0, 0], [0.5, -0.5]], np.float32)
    assert policy.surrogate_losses(proposal, labels) == pytest.approx([0, 0.5])
