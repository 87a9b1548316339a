"""Learning curves as values: what each round of each method came to, over all training seeds."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from sheath_manip.learning.pooled import Field, episodes_of, figures_of_runs
from sheath_manip.learning.results import EXPERT, RoundResult
from sheath_manip.metrics import (
    RATES,
    EpisodeRecord,
    Figures,
    expert_share,
    expert_share_interval,
    figures_of,
)

SHARE = "expert_share"
"""the one quantity that is no rate and no metric"""
_NAN = float("nan")


@dataclass(frozen=True)
class Reading:
    """One quantity in one round of one method."""

    value: float
    """over the episodes of all training seeds; NaN where nothing was measured"""
    interval: tuple[float, float]
    """95 %"""
    episodes: int
    seeds: Mapping[int, float]
    """of each training seed alone"""


Line = Mapping[int, Reading]
"""a method's readings by round, in their order"""


class Curves:
    """The curves of all results so far; only a round that a new result belongs to is read anew."""

    def __init__(self, metric: str) -> None:
        """Store the name of the task's `metric`."""
        self.metric = metric
        self._results: dict[tuple[str, int], dict[int, RoundResult]] = {}
        self._readings: dict[tuple[str, int], dict[tuple[Field, str], Reading]] = {}

    def take(self, results: Sequence[RoundResult]) -> None:
        """Take note of `results`, some or all of which may be known."""
        for result in results:
            key = result.method, result.round
            # All methods of a seed tell of the round that they share.
            seeds = self._results.setdefault(key, {})
            if result.run_seed not in seeds:
                seeds[result.run_seed] = result
                self._readings.pop(key, None)
        for key, seeds in self._results.items():
            if key not in self._readings:
                self._readings[key] = self._read(list(seeds.values()))

    @property
    def methods(self) -> list[str]:
        """The methods, in the order in which they began."""
        return [name for name in dict.fromkeys(name for name, _ in self._results) if name != EXPERT]

    def line(self, method: str, field: Field, quantity: str) -> Line:
        """Return what there is of a method, or of EXPERT: a rate, the metric, or SHARE."""
        return {
            number: self._readings[name, number][field, quantity]
            for name, number in sorted(self._readings)
            if name == method
        }

    def _read(self, results: list[RoundResult]) -> dict[tuple[Field, str], Reading]:
        names = (*RATES.values(), self.metric)
        fields: tuple[Field, ...] = ("executed", "policy")
        readings = {}
        for field in fields:
            figures = figures_of_runs(results, field)
            alone = {each.run_seed: figures_of(getattr(each, field)) for each in results}
            for name in names:
                seeds = {seed: _value(of_seed, name) for seed, of_seed in alone.items()}
                interval = figures.ci95.get(name, (_NAN, _NAN))
                readings[field, name] = Reading(
                    _value(figures, name), interval, figures.episodes, dict(sorted(seeds.items()))
                )
        readings["executed", SHARE] = _share(results)
        return readings


def _value(figures: Figures, name: str) -> float:
    if name in RATES.values():
        return getattr(figures, name)
    return figures.metric.get(name, _NAN)


def _share(results: list[RoundResult]) -> Reading:
    records: list[EpisodeRecord] = episodes_of(results, "executed")
    seeds = {each.run_seed: expert_share(each.executed) for each in results}
    interval = expert_share_interval(records)
    return Reading(expert_share(records), interval, len(records), dict(sorted(seeds.items())))
