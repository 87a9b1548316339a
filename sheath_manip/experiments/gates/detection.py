"""How well scores tell two kinds of states apart. A score is high inside; NaN is outside."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.stats import rankdata

from sheath_manip.metrics import rate_interval


@dataclass(frozen=True)
class Rate:
    """A share of cases."""

    hits: int
    count: int
    value: float = field(init=False)
    """NaN where nothing was counted"""
    ci95: tuple[float, float] = field(init=False)
    """Wilson's; the cases count as independent"""

    def __post_init__(self) -> None:
        value = self.hits / self.count if self.count else float("nan")
        object.__setattr__(self, "value", value)
        object.__setattr__(self, "ci95", rate_interval(self.hits, self.count))


def rate_of(mask: NDArray | Sequence[bool]) -> Rate:
    """The share of cases in which `mask` (n,) holds."""
    return Rate(int(np.count_nonzero(mask)), len(mask))


def alarms(scores: NDArray, threshold: float) -> NDArray[np.bool_]:
    """(n,) where a gate with this threshold hands over."""
    return ~(scores >= threshold)


def auroc(inside: NDArray, outside: NDArray) -> float:
    """The chance that a state of `outside` scores lower than one of `inside`; ties count half.

    NaN where either is empty.
    """
    if not (len(inside) and len(outside)):
        return float("nan")
    ranks = rankdata(np.concatenate([_ordered(inside), _ordered(outside)]))
    above = ranks[: len(inside)].sum() - len(inside) * (len(inside) + 1) / 2
    return float(above / (len(inside) * len(outside)))


def detected(inside: NDArray, outside: NDArray, false_alarm_rates: NDArray) -> NDArray[np.float64]:
    """(r,) the share of `outside` found by the highest threshold with no more false alarms.

    Args:
        inside: (n,) scores, of which at most each of the (r,) rates may lie below the threshold.
        outside: (m,) scores that should lie below it.
        false_alarm_rates: (r,) each 0..1.
    """
    if not (len(inside) and len(outside)):
        return np.full(len(false_alarm_rates), np.nan)
    # One threshold more, above all scores.
    thresholds = np.append(np.sort(_ordered(inside)), np.inf)
    # A rate such as 3 / 10 times 10 may come out a little below 3.
    allowed = np.floor(np.asarray(false_alarm_rates) * len(inside) + 1e-9).astype(int)
    return (_ordered(outside)[None] < thresholds[allowed][:, None]).mean(axis=1)


def _ordered(scores: NDArray) -> NDArray[np.float64]:
    return np.where(np.isnan(scores), -np.inf, scores)
