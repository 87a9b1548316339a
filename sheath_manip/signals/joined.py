"""Several signals as one: the joint rarity of their scores among the expert's own steps.

Fisher's method (1932): of each signal's score the share p of held-out expert steps that score
lower is taken, and the logarithms are added. A state that one signal finds impossible is so
whatever the others say, and two mild suspicions add up. Good (1955), 'On the weighted combination
of significance tests', lets one signal count more than another.
"""

from bisect import bisect_left
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import isnan, log
from typing import Self

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError
from sheath_manip.policies.learned_arrays import numbers
from sheath_manip.policies.nested_arrays import flatten, subtree
from sheath_manip.policies.readings import each_once
from sheath_manip.protocols import (
    Agreement,
    Arrays,
    HasPrecedents,
    PredictingPolicy,
    Reader,
    Refits,
    Signal,
)
from sheath_manip.types import Reason, SignalScore
from sheath_manip.types.seen import Precedents, Seen

LEAST_SHARE = 1e-3
"""added to every p: a few thousand steps say no more of what is rarer"""
TAIL = 0.05
"""below the lowest score of the expert an exponential tail goes on as steeply as p falls from this
quantile to the lowest score, so that what is farther out ranks lower"""
STEEPNESS = log(TAIL / LEAST_SHARE)


@dataclass(frozen=True, eq=False)
class Reference:
    """How the scores of held-out expert steps lie, to say how rare another one is."""

    scores: NDArray[np.float64]
    """(m,) sorted"""
    spread: float
    """from the lowest to the TAIL quantile"""
    logs: NDArray[np.float64]
    """(m + 1,) the logarithm of each share that can be; like the spread it is found once, since it
    takes longer than all the rest"""

    @classmethod
    def of(cls, scores: NDArray[np.float64]) -> Self:
        """Measure how (m,) sorted `scores` lie; m is at least 1."""
        spread = max(float(np.quantile(scores, TAIL) - scores[0]), 1e-12)
        shares = np.arange(len(scores) + 1) / len(scores)
        return cls(scores, spread, np.log(shares + LEAST_SHARE))

    @cached_property
    def _listed(self) -> tuple[list[float], list[float]]:
        """Scores and logs, for single scores: numpy takes ten times as long for one as Python."""
        return self.scores.tolist(), self.logs.tolist()

    def share(self, score: float) -> float:
        """Return the share of the m that is below `score`."""
        return bisect_left(self._listed[0], score) / len(self.scores)

    def log_share_of_one(self, score: float) -> float:
        """Return what `log_share` gives for a single score."""
        scores, logs = self._listed
        # The minimum of NaN, where it comes first, is NaN.
        beyond = min((score - scores[0]) / self.spread, 0.0)
        return logs[bisect_left(scores, score)] + STEEPNESS * beyond

    def log_share(self, scores: NDArray[np.float64]) -> NDArray[np.float64]:
        """(n,) the logarithm of the share of the m below each of (n,) `scores`; NaN for NaN."""
        below = self.scores.searchsorted(scores)
        # The minimum of NaN is NaN.
        beyond = np.minimum((scores - self.scores[0]) / self.spread, 0.0)
        return self.logs[below] + STEEPNESS * beyond


class JoinedSignal:
    """The weighted sum of its signals' log p: 0 where none ever scored higher, else negative.

    The shares are taken from the very steps that a threshold is then calibrated on, which makes a
    step's own share too high by one step in all of them.
    """

    def __init__(
        self, signals: Mapping[str, Signal], weights: Mapping[str, float] | None = None
    ) -> None:
        """Store the signals by name, and what each counts: all alike where no weights are given.

        ParameterError where there are fewer than two, or not one positive weight for each.
        """
        if len(signals) < 2:
            raise ParameterError(f"got {len(signals)} signals to join; wanted at least 2")
        weights = dict.fromkeys(signals, 1.0) if weights is None else weights
        if weights.keys() != signals.keys() or not all(w > 0 for w in weights.values()):
            raise ParameterError(
                f"got weights {dict(weights)} for signals {list(signals)}; wanted one above 0 each"
            )
        self.signals = signals
        self.weights = weights

    @property
    def uses_displaced(self) -> bool:
        """Whether any signal's `fit` needs `Seen.displaced`."""
        return any(signal.uses_displaced for signal in self.signals.values())

    def attach(self, policy: PredictingPolicy) -> tuple[Reader, ...]:
        """Read for every signal; equal readers read once."""
        return each_once(
            reader for signal in self.signals.values() for reader in signal.attach(policy)
        )

    def fit(self, labels: NDArray, seen: Seen, agreement: Agreement | None = None) -> Self:
        """Fit every signal; none is joined before `calibrate`."""
        for signal in self.signals.values():
            signal.fit(labels, seen, agreement)
        return self

    def refit(self, seen: Seen) -> Self:
        """Refit the signals that can be; joined as before, until `calibrate`."""
        for signal in self.signals.values():
            if isinstance(signal, Refits):
                signal.refit(seen)
        return self

    def measure(self, seen: Seen) -> NDArray[np.float64]:
        """(n, signals) the score of each signal."""
        measured = np.empty((len(seen), len(self.signals)))
        for column, signal in enumerate(self.signals.values()):
            measured[:, column] = signal.scores(signal.measure(seen))
        return measured

    def calibrate(self, measures: Sequence[NDArray]) -> Self:
        """Learn how held-out expert episodes score; ParameterError where a signal has no score.

        A step without a score, or with -inf, says nothing of how the others lie and is left out.
        """
        together = np.concatenate([np.empty((0, len(self.signals))), *measures])
        self.references_: dict[str, Reference] = {}
        for name, scores in zip(self.signals, together.T, strict=True):
            known = np.sort(scores[np.isfinite(scores)])
            if len(known) < 1 / TAIL:
                raise ParameterError(
                    f"signal {name!r} scores {len(known)} steps of {len(measures)} held-out "
                    f"episodes; wanted at least {round(1 / TAIL)} to compare others with"
                )
            self.references_[name] = Reference.of(known)
        return self

    def scores(self, measures: NDArray) -> NDArray[np.float64]:
        """(n,) weighted sums of log p; NaN where a signal has no score."""
        if len(measures) == 1:
            # A step of a robot asks for one, and arrays of one take several times as long.
            return np.array([sum(self._parts_of_one(measures[0]).values())])
        return sum(self.parts(measures).values(), np.zeros(len(measures)))

    def parts(self, measures: NDArray) -> Mapping[str, NDArray[np.float64]]:
        """(n,) what each signal adds to the score, by name."""
        return {
            name: self.weights[name] * self.references_[name].log_share(scores)
            for name, scores in zip(self.signals, measures.T, strict=True)
        }

    def _parts_of_one(self, measures: NDArray) -> dict[str, float]:
        """Return what `parts` does for the (signals,) scores of one state."""
        return {
            name: self.weights[name] * self.references_[name].log_share_of_one(score)
            for name, score in zip(self.signals, measures.tolist(), strict=True)
        }

    def signal_scores(self, measures: NDArray) -> tuple[SignalScore, ...]:
        """Return each signal's score in one state, (p,), sorted by name, with its share."""
        by_name = sorted(zip(self.signals, measures.tolist(), strict=True))
        return tuple(
            SignalScore(name, score, self.references_[name].share(score))
            for name, score in by_name
            if not isnan(score)
        )

    def nearest_states(self, seen: Seen, count: int) -> Precedents | None:
        """Return what the first of the signals that knows precedents says."""
        known = (each for each in self.signals.values() if isinstance(each, HasPrecedents))
        signal = next(known, None)
        return None if signal is None else signal.nearest_states(seen, count)

    def blames(self, measures: NDArray) -> Reason:
        """Return the reason of the signal that finds the state rarest, however much it counts."""
        parts = self._parts_of_one(measures)
        rarest = min(parts, key=lambda name: parts[name] / self.weights[name])
        place = list(self.signals).index(rarest)
        return self.signals[rarest].blames(measures[place : place + 1])

    def arrays(self) -> Arrays:
        """Return each signal's arrays, and the (m,) sorted scores of held-out expert steps."""
        learned = {name: signal.arrays() for name, signal in self.signals.items()}
        references = {f"reference/{name}": each.scores for name, each in self.references_.items()}
        return {**flatten(learned), **references}

    def load(self, arrays: Arrays) -> Self:
        """Take over `arrays()`; ParameterError for references that are not sorted."""
        for name, signal in self.signals.items():
            signal.load(subtree(arrays, name))
        self.references_ = {}
        for name in self.signals:
            scores = numbers(subtree(arrays, "reference"), name, None).astype(float)
            if not len(scores) or (np.diff(scores) < 0).any():
                raise ParameterError(f"reference {name!r} has {len(scores)} scores; wanted sorted")
            self.references_[name] = Reference.of(scores)
        return self
