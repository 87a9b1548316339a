"""How expert episodes that no fit has seen score: what a score is held against."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError
from sheath_manip.policies.learned_arrays import numbers
from sheath_manip.protocols import Arrays

NEVER = -float(np.finfo(np.float32).max)
"""in a file, in place of a score that is none: a file holds finite numbers alone"""


@dataclass(frozen=True, eq=False)
class HeldOut:
    """The scores of the episodes' steps."""

    episodes: tuple[NDArray[np.float64], ...] = ()
    """(n_k,) each; -inf where a step has no score, which is below any threshold"""

    @classmethod
    def of(cls, scores: Sequence[NDArray]) -> Self:
        """Take (n_k,) scores of each episode."""
        return cls(tuple(np.where(np.isnan(each), -np.inf, each) for each in scores))

    def share(self, score: float) -> float:
        """Return the share of the steps that score lower; NaN where there is no step."""
        ordered = self._ordered
        return int(ordered.searchsorted(score)) / len(ordered) if len(ordered) else float("nan")

    def arrays(self) -> Arrays:
        """Return the scores of all episodes, and how many each has."""
        scores = np.concatenate([np.empty(0), *self.episodes])
        lengths = np.array([len(each) for each in self.episodes], np.int64)
        return {"scores": np.where(np.isfinite(scores), scores, NEVER), "lengths": lengths}

    @classmethod
    def load(cls, arrays: Arrays) -> Self:
        """Return what `arrays` gave, none where they are none; raises ParameterError."""
        if not arrays:
            return cls()
        scores = numbers(arrays, "scores", None).astype(np.float64)
        lengths = numbers(arrays, "lengths", None).astype(np.int64)
        if (lengths < 0).any() or lengths.sum() != len(scores):
            raise ParameterError(
                f"the held-out episodes have {len(scores)} scores; wanted {lengths.sum()}"
            )
        scores = np.where(scores <= NEVER, -np.inf, scores)
        return cls(tuple(np.split(scores, np.cumsum(lengths)[:-1])) if len(lengths) else ())

    @cached_property
    def _ordered(self) -> NDArray[np.float64]:
        return np.sort(np.concatenate([np.empty(0), *self.episodes]))
