"""Chunks of labels and histories of observations, which never cross a gap."""

import numpy as np
import pytest

from sheath_manip.exceptions import ParameterError
from sheath_manip.types.columns import ACTORS
from sheath_manip.types.history import chunk_targets, last_observations
from sheath_manip.types.samples import Samples, joined, samples_from, visited_from
from tests.episodes import episode_of


def samples_of(episodes, steps, actors, labels=None) -> Samples:
    count = len(episodes)
    values = np.arange(count, dtype=np.float32)[:, None]
    return Samples(
        {"top": np.arange(count, dtype=np.uint8)[:, None, None, None]},
        values,
        values if labels is None else np.array(labels, np.float32)[:, None],
        np.array(episodes),
        np.array(steps, np.int32),
        np.array(actors, np.uint8),
    )


def naive_chunk(samples: Samples, row: int, length: int) -> list[float]:
    """Labels step by step, None behind a gap."""
    at = {
        (episode, step): place
        for place, (episode, step) in enumerate(zip(samples.episodes, samples.steps, strict=True))
    }
    found = []
    for ahead in range(length):
        place = at.get((samples.episodes[row], samples.steps[row] + ahead))
        if place is None or samples.actors[place] != samples.actors[row]:
            break
        found.append(float(samples.labels[place, 0]))
    return found


def test_a_chunk_ends_at_a_change_of_actor_a_missing_step_and_the_episodes_end():
    samples = samples_of([0, 0, 0, 0, 0, 1, 1], [0, 1, 2, 4, 5, 6, 7], [1, 1, 0, 0, 0, 0, 0])
    chunks = chunk_targets(samples, 3)
    assert chunks.labels.shape == (7, 3, 1)
    lengths = chunks.known.sum(axis=1).tolist()
    assert lengths == [2, 1, 1, 2, 1, 2, 1]
    assert chunks.labels[0, :, 0].tolist() == [0, 1, 1]
    assert chunks.labels[3, :, 0].tolist() == [3, 4, 4]


@pytest.mark.parametrize("seed", range(5))
def test_chunks_are_those_found_step_by_step_in_any_order(seed):
    rng = np.random.default_rng(seed)
    kept = rng.permutation(np.flatnonzero(rng.random(60) < 0.8))
    samples = samples_of(kept // 20, kept % 20, rng.integers(0, 2, 60)[kept] * (kept % 7 < 4))
    chunks = chunk_targets(samples, 5)
    for row in range(len(samples)):
        wanted = naive_chunk(samples, row, 5)
        assert chunks.labels[row][chunks.known[row], 0].tolist() == wanted
        assert chunks.known[row].tolist() == [place < len(wanted) for place in range(5)]


def test_a_history_crosses_a_change_of_actor_and_no_missing_step():
    samples = samples_of([0, 0, 0, 0, 1], [0, 1, 3, 4, 0], [1, 0, 0, 1, 1])
    seen, known = last_observations(samples, 3)
    assert seen.features[:, :, 0].tolist() == [
        [0, 0, 0],
        [0, 0, 1],
        [2, 2, 2],
        [2, 2, 3],
        [4, 4, 4],
    ]
    assert known.sum(axis=1).tolist() == [1, 2, 1, 2, 1]
    assert seen.images["top"].shape == (5, 3, 1, 1, 1)
    np.testing.assert_array_equal(seen.images["top"][:, :, 0, 0, 0], seen.features[:, :, 0])


def test_no_states_have_no_chunks():
    nothing = samples_of([], [], [])
    assert chunk_targets(nothing, 4).labels.shape == (0, 4, 1)
    assert last_observations(nothing, 2)[0].features.shape == (0, 2, 1)


def test_what_cannot_be_is_refused():
    samples = samples_of([0, 0], [0, 1], [0, 0], labels=[1.0, np.nan])
    with pytest.raises(ParameterError, match="wanted labelled states"):
        chunk_targets(samples, 2)
    with pytest.raises(ParameterError, match="at least 1 action"):
        chunk_targets(samples.labelled(), 0)
    with pytest.raises(ParameterError, match="at least 1 observation"):
        last_observations(samples, 0)


def test_samples_know_step_and_actor_from_an_episodes_columns():
    episodes = [episode_of("ppee"), episode_of("epe")]
    visited = visited_from(episodes)
    assert visited.steps.tolist() == [0, 1, 2, 3, 0, 1, 2]
    names = [str(ACTORS[place])[0] for place in visited.actors]
    assert "".join(names) == "ppeeepe"
    labelled, taken = samples_from(episodes), visited.labelled()
    for samples in (labelled, joined([labelled]), taken):
        np.testing.assert_array_equal(samples.steps, taken.steps)
        np.testing.assert_array_equal(samples.actors, taken.actors)
    assert labelled.steps.dtype == np.int32
    assert labelled.actors.dtype == np.uint8
    both = joined([visited, visited])
    assert both.steps.tolist() == 2 * visited.steps.tolist()


def test_where_no_step_is_told_they_are_counted_as_they_come():
    states = np.zeros((5, 1), np.float32)
    samples = Samples({}, states, states, np.array([3, 1, 3, 3, 1]))
    assert samples.steps.tolist() == [0, 0, 1, 2, 1]
    assert {str(ACTORS[place]) for place in samples.actors} == {"expert"}
