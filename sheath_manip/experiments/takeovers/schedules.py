"""Takeovers that look at nothing, as often and as long as a gate's: baselines of equal burden.

An episode that fails soon leaves little time to be called in. Were calls drawn by the time that the
gate's episodes took, which it saved and made long, the baselines would be called less often than
the gate. They are drawn by the time that the policy alone takes, in which each can still help. What
is equal so is the rate: where some scenes are much longer than others these get most of the calls,
and a scene has fewer in the mean than under the gate. Each result says how many there were.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from sheath_manip.experiments.takeovers.trial import Trial, mean_share

Turns = tuple[tuple[int, int], ...]

OVERTIME = 2.0
"""schedules go on for so many of the longest episodes that the gate had"""


@dataclass(frozen=True)
class Gated:
    """What a gate did on all scenes of a lot."""

    trials: Sequence[Trial]
    alone_steps: Sequence[int]
    """of each scene, how many steps the policy alone has"""

    @property
    def failing(self) -> Self:
        """The scenes that fail alone, whose burden counts; all where there is none."""
        pairs = zip(self.trials, self.alone_steps, strict=True)
        failing = [(trial, steps) for trial, steps in pairs if trial.failing]
        if not failing:
            return self
        trials, alone_steps = zip(*failing, strict=True)
        return type(self)(trials, alone_steps)

    @property
    def horizon(self) -> int:
        """The step with which schedules end."""
        return round(OVERTIME * max(*(trial.steps for trial in self.trials), *self.alone_steps))


Schedule = Callable[[Gated, int, np.random.Generator], Turns]
"""from what a gate did, the place of a scene, and draws: when the expert acts"""


def random_steps(gated: Gated, index: int, rng: np.random.Generator) -> Turns:
    """Single steps, each drawn with the gate's share."""
    del index
    drawn = rng.random(gated.horizon) < mean_share(gated.failing.trials)
    return tuple((int(step), 1) for step in np.flatnonzero(drawn))


def every_so_many(gated: Gated, index: int, rng: np.random.Generator) -> Turns:
    """Every k-th step, by the gate's share, from a drawn one on."""
    del index
    share = mean_share(gated.failing.trials)
    if not share > 0:
        return ()
    apart = max(1, round(1 / share))
    return tuple((step, 1) for step in range(int(rng.integers(apart)), gated.horizon, apart))


def random_blocks(gated: Gated, index: int, rng: np.random.Generator) -> Turns:
    """Turns of the gate's number and lengths in some scene, at random times of the policy's."""
    trials = gated.failing.trials
    return _at_random_times(trials[int(rng.integers(len(trials)))], gated.alone_steps[index], rng)


def own_at_random(gated: Gated, index: int, rng: np.random.Generator) -> Turns:
    """The gate's own turns in this scene, at random times of the policy's."""
    return _at_random_times(gated.trials[index], gated.alone_steps[index], rng)


def anothers(gated: Gated, index: int, rng: np.random.Generator) -> Turns:
    """The gate's turns in another scene, at their times."""
    trials = gated.trials
    if len(trials) < 2:
        return ()
    return trials[(index + int(rng.integers(1, len(trials)))) % len(trials)].turns


def _at_random_times(trial: Trial, steps: int, rng: np.random.Generator) -> Turns:
    """Place a trial's turns anew, each where fewer than `steps` are the policy's before it."""
    lengths = np.asarray([count for _, count in trial.turns], int)
    # Where the policy has none, all comes at the beginning.
    steps = max(steps, 1)
    # With a step of the policy between any two, or they were one.
    begun = np.sort(rng.choice(steps, len(lengths), replace=len(lengths) > steps))
    ordered = rng.permutation(lengths)
    # The expert's own steps are none of the policy's.
    starts = begun + np.cumsum(ordered) - ordered
    return tuple((int(start), int(count)) for start, count in zip(starts, ordered, strict=True))


SCHEDULES: dict[str, Schedule] = {
    "random-steps": random_steps,
    "every-kth-step": every_so_many,
    "random-blocks": random_blocks,
    "own-at-random-times": own_at_random,
    "another-scenes": anothers,
}
