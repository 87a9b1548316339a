"""Random blocks come as often as a gate's takeovers, are as long, and look at nothing."""

import numpy as np
import pytest

from sheath_manip.exceptions import ParameterError
from sheath_manip.gates.blocks import BlocksConfig, RandomBlocks
from sheath_manip.metrics import runs_of
from sheath_manip.types import Actor, Observation, Proposal, Reason

SEEN = Observation({}, np.zeros(1, np.float32), 0.0)
PROPOSED = Proposal(np.zeros((1, 1), np.float32))
STEPS = 200


def blocks(config: BlocksConfig, seed: int) -> list[int]:
    """The lengths of the takeovers in an episode; one that its end cuts off is left out."""
    gate = RandomBlocks(config)
    gate.reset(np.random.default_rng(seed))
    decisions = [gate.decide(SEEN, PROPOSED) for _ in range(STEPS)]
    assert all(each.query is (each.actor is Actor.EXPERT) for each in decisions)
    runs = runs_of(np.array([each.actor is Actor.EXPERT for each in decisions]))
    return [stop - start for start, stop in runs if stop < STEPS]


def test_they_are_as_many_and_as_long_as_those_they_are_like():
    turns = [[10], [5, 10, 20], [], [20]]
    config = BlocksConfig.like(turns, policy_steps=4 * STEPS - sum(map(sum, turns)))
    found = [blocks(config, seed) for seed in range(600)]
    lengths = [length for episode in found for length in episode]
    assert set(lengths) == {5, 10, 20}
    # As many as 5 in 4 episodes, but for those that the end cuts off; the spread is Poisson's.
    assert np.mean([len(each) for each in found]) == pytest.approx(1.25, abs=0.15)
    assert np.mean(lengths) == pytest.approx(13, abs=1)


def test_two_blocks_are_two_takeovers():
    assert blocks(BlocksConfig(1.0, (3,)), 0) == [3] * (STEPS // 4)


def test_where_nobody_took_over_nobody_does():
    assert BlocksConfig.like([[], []], 100) == BlocksConfig()
    assert blocks(BlocksConfig(), 0) == []


def test_an_expert_that_always_drove_drives_always():
    config = BlocksConfig.like([[STEPS], [STEPS]], policy_steps=0)
    assert (config.rate, config.steps) == (1.0, (STEPS, STEPS))


def test_an_invalid_proposal_shifts_no_draw():
    def actors(invalid: int) -> list[Actor]:
        gate = RandomBlocks(BlocksConfig(0.2, (4,)))
        gate.reset(np.random.default_rng(3))
        decisions = [gate.decide(SEEN, None if t == invalid else PROPOSED) for t in range(60)]
        assert invalid < 0 or decisions[invalid].reason is Reason.INVALID_PROPOSAL
        return [each.actor for t, each in enumerate(decisions) if t != 7]

    assert actors(7) == actors(-1)


@pytest.mark.parametrize(
    ("rate", "steps", "wanted"),
    [(1.5, (3,), "wanted a probability"), (0.1, (0,), "at least 1"), (0.1, (), "steps is empty")],
)
def test_what_is_no_block_is_refused(rate, steps, wanted):
    with pytest.raises(ParameterError, match=wanted):
        BlocksConfig(rate, steps)
