"""An episode that was read: its columns as they are stored, and its steps once one is asked for.

Training, counts and the page's traces look at columns alone, and a step takes longer to be made
than its part of the file to be read.
"""

import math
from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import overload

import numpy as np
from numpy.typing import NDArray

from sheath_manip.dataset.broken_steps import broken_by_step
from sheath_manip.dataset.header import Header
from sheath_manip.dataset.layout import LIMITED, SIGNALS, Arrays
from sheath_manip.dataset.waits import waits_between
from sheath_manip.types import Episode, GateDecision, Limited, Observation, SignalScore, Step
from sheath_manip.types.columns import ACTORS, REASONS, Columns, intervening

_NUMBERS = (
    "actor",
    "reason",
    "score",
    "threshold",
    "query",
    "reward",
    "time_s",
    "has_proposed",
    "has_labelled",
)
_ROWS = ("features", "state", "proposed", "labelled", "executed")


def episode_from(header: Header, arrays: Arrays) -> Episode:
    """The episode of `header`; where `arrays` lacks images, its observations have none."""
    steps = StoredSteps(header, arrays)
    episode = Episode(
        info=header.info,
        steps=steps,
        final_observation=Observation(
            {camera: arrays[f"final/images/{camera}"] for camera in steps.cameras},
            arrays["final/features"],
            float(arrays["final/time_s"]),
            header.instruction,
        ),
        final_state=arrays["final/state"],
        terminated=header.terminated,
        truncated=header.truncated,
        outcome=header.outcome,
        metrics=header.metrics,
        cut_short_by=next(iter(steps.broken.get(header.length, ())), None),
    )
    # Where the cached property keeps them: a copy with other steps makes its own.
    vars(episode)["columns"] = columns_from(header, arrays)
    return episode


class StoredSteps(Sequence[Step]):
    """The steps of an episode, made of its arrays when the first one is asked for."""

    def __init__(self, header: Header, arrays: Arrays) -> None:
        self._header, self._arrays = header, arrays
        self.cameras = [camera for camera in header.cameras if f"images/{camera}" in arrays]
        self.broken = broken_by_step(header.broken, header.length)

    def __len__(self) -> int:
        return self._header.length

    @overload
    def __getitem__(self, place: int) -> Step: ...
    @overload
    def __getitem__(self, place: slice) -> tuple[Step, ...]: ...
    def __getitem__(self, place: int | slice) -> Step | tuple[Step, ...]:
        return self._made[place]

    def __iter__(self) -> Iterator[Step]:
        return iter(self._made)

    @cached_property
    def _made(self) -> tuple[Step, ...]:
        header, arrays = self._header, self._arrays
        # As lists of rows and of plain numbers: one at a time, numpy takes twice as long.
        (
            actors,
            reasons,
            scores,
            thresholds,
            queries,
            rewards,
            times_s,
            has_proposed,
            has_labelled,
        ) = (arrays[name].tolist() for name in _NUMBERS)
        features, states, proposed, labelled, executed = (list(arrays[name]) for name in _ROWS)
        images = {camera: list(arrays[f"images/{camera}"]) for camera in self.cameras}
        waited_s = {wait.step: wait.waited_s for wait in header.waits}
        limited = arrays[LIMITED].tolist() if header.limits else None
        signals = arrays[SIGNALS].tolist() if header.signals else [[]] * header.length
        return tuple(
            Step(
                observation=Observation(
                    {camera: frames[t] for camera, frames in images.items()},
                    features[t],
                    times_s[t],
                    header.instruction,
                ),
                state=states[t],
                proposed=proposed[t] if has_proposed[t] else None,
                labelled=labelled[t] if has_labelled[t] else None,
                decision=GateDecision(
                    header.actors[actors[t]],
                    queries[t],
                    header.reasons[reasons[t]],
                    scores[t],
                    thresholds[t],
                    self.broken.get(t, ()),
                    waited_s.get(t, 0.0),
                    tuple(
                        SignalScore(name, score, share)
                        for name, (score, share) in zip(header.signals, signals[t], strict=True)
                        if not math.isnan(score)
                    ),
                ),
                executed=executed[t],
                reward=rewards[t],
                limited=() if limited is None else _limits(header, limited[t]),
            )
            for t in range(header.length)
        )


def columns_from(header: Header, arrays: Arrays) -> Columns:
    """The steps by column, equal to those that `Columns.of` makes of them one by one."""
    actor = _places(header.actors, ACTORS)[arrays["actor"]]
    reason = _places(header.reasons, REASONS)[arrays["reason"]]
    waited_s = np.zeros(header.length)
    # Pieces that were exported before 2026-12 tell of waits beyond their end.
    for wait in waits_between(header.waits, 0, header.length):
        waited_s[wait.step] = wait.waited_s
    limited = np.zeros(header.length, bool)
    if header.limits:
        np.any(~np.isnan(arrays[LIMITED]), axis=1, out=limited)
    return Columns(
        **{name: arrays[name] for name in ("time_s", *_ROWS, "has_proposed", "has_labelled")},
        actor=actor,
        reason=reason,
        query=arrays["query"],
        score=arrays["score"],
        threshold=arrays["threshold"],
        reward=arrays["reward"],
        limited=limited,
        intervention=intervening(
            actor, reason, arrays["has_proposed"], driven=bool(header.info.checkpoint)
        ),
        waited_s=waited_s,
        signals=_signals(header, arrays),
    )


def _places(stored: Sequence[str], known: Sequence[str]) -> NDArray[np.uint8]:
    """The place among those `known` of each that a header names."""
    return np.array([known.index(each) for each in stored], np.uint8)


def _signals(header: Header, arrays: Arrays) -> dict[str, NDArray[np.float64]]:
    """(T, 2) by signal, of those that have a score in any step."""
    signals = {}
    for number, name in enumerate(header.signals):
        column = arrays[SIGNALS][:, number]
        known = ~np.isnan(column[:, 0])
        if known.any():
            signals[name] = np.where(known[:, None], column, np.nan)
    return dict(sorted(signals.items()))


def _limits(header: Header, shares: list[float]) -> tuple[Limited, ...]:
    """Those that changed a command."""
    limits = zip(header.limits, shares, strict=True)
    return tuple(Limited(limit, by) for limit, by in limits if not math.isnan(by))
