"""Takeovers that look at nothing, as often and as long as a gate's: baselines of equal burden."""

from collections.abc import Callable, Sequence

import numpy as np

from sheath_manip.experiments.takeovers.trial import Trial, mean_share

Turns = tuple[tuple[int, int], ...]
Schedule = Callable[[Sequence[Trial], int, np.random.Generator], Turns]
"""from a gate's trials on all scenes, the place of one of them, and draws: when the expert acts"""

OVERTIME = 2.0
"""schedules go on for so many of the longest episodes that the gate had"""


def random_steps(trials: Sequence[Trial], index: int, rng: np.random.Generator) -> Turns:
    """Single steps, each drawn with the gate's share."""
    del index
    hard = _hard(trials)
    drawn = rng.random(_horizon(trials)) < mean_share(hard)
    return tuple((int(step), 1) for step in np.flatnonzero(drawn))


def every_so_many(trials: Sequence[Trial], index: int, rng: np.random.Generator) -> Turns:
    """Every k-th step, by the gate's share, from a drawn one on."""
    del index
    share = mean_share(_hard(trials))
    if not share > 0:
        return ()
    apart = max(1, round(1 / share))
    return tuple((step, 1) for step in range(int(rng.integers(apart)), _horizon(trials), apart))


def random_blocks(trials: Sequence[Trial], index: int, rng: np.random.Generator) -> Turns:
    """Blocks that come as often as the gate's turns, each as long as a drawn one of them.

    As often in the policy's time: where an episode ends sooner, fewer of them come.
    """
    del index
    hard = _hard(trials)
    lengths = [count for trial in hard for _, count in trial.turns]
    free = sum(trial.steps - trial.expert_steps for trial in hard)
    if not lengths:
        return ()
    turns: list[tuple[int, int]] = []
    step = 0
    while True:
        step += int(rng.geometric(min(1.0, len(lengths) / max(free, 1)))) - 1
        if step >= _horizon(trials):
            return tuple(turns)
        turns.append((step, lengths[int(rng.integers(len(lengths)))]))
        step += turns[-1][1]


def own_at_random(trials: Sequence[Trial], index: int, rng: np.random.Generator) -> Turns:
    """The gate's own turns in this scene, at random times of it."""
    trial = trials[index]
    return _placed([count for _, count in trial.turns], trial.steps, rng)


def anothers(trials: Sequence[Trial], index: int, rng: np.random.Generator) -> Turns:
    """The gate's turns in another scene, at their times."""
    if len(trials) < 2:
        return ()
    return trials[(index + int(rng.integers(1, len(trials)))) % len(trials)].turns


SCHEDULES: dict[str, Schedule] = {
    "random-steps": random_steps,
    "every-kth-step": every_so_many,
    "random-blocks": random_blocks,
    "own-at-random-times": own_at_random,
    "another-scenes": anothers,
}


def _horizon(trials: Sequence[Trial]) -> int:
    return round(OVERTIME * max(trial.steps for trial in trials))


def _placed(lengths: Sequence[int], steps: int, rng: np.random.Generator) -> Turns:
    """Turns of these lengths in a drawn order, the room between them drawn: none overlap."""
    if not lengths:
        return ()
    ordered = rng.permutation(np.asarray(lengths))
    room = max(steps - int(ordered.sum()), 0)
    # Of all ways to put the room before, between and behind them, each is as likely.
    gaps = np.sort(rng.integers(0, room + 1, len(ordered)))
    starts = gaps + np.concatenate([[0], np.cumsum(ordered)[:-1]])
    return tuple((int(start), int(count)) for start, count in zip(starts, ordered, strict=True))


def _hard(trials: Sequence[Trial]) -> list[Trial]:
    """Those of scenes that fail alone, whose burden counts; all where there is none."""
    return [trial for trial in trials if trial.failing] or list(trials)
