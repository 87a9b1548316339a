"""What rounds of several training seeds say together, the same for the page and for a summary."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

import numpy as np

from sheath_manip.learning.results import RoundResult
from sheath_manip.metrics import EpisodeRecord, Figures, bounded_interval, figures_of

MANY_RUNS = 10
"""training runs from which on a metric's interval is over their means: the episodes of a run
resemble each other, but of a few runs an interval says nothing"""

Field = Literal["executed", "policy", "final"]
"""of a RoundResult, that holds episodes"""


def episodes_of(results: Sequence[RoundResult], field: Field) -> list[EpisodeRecord]:
    """Return the episodes of all `results`."""
    return [record for result in results for record in getattr(result, field)]


def figures_of_runs(results: Sequence[RoundResult], field: Field) -> Figures:
    """Figures of the episodes in `field`; of many runs, metrics' intervals are over the runs."""
    figures = figures_of(episodes_of(results, field))
    by_run: dict[int, list[EpisodeRecord]] = {}
    for result in results:
        by_run.setdefault(result.run_seed, []).extend(getattr(result, field))
    runs = [records for records in by_run.values() if records]
    if len(runs) < MANY_RUNS:
        return figures
    over_runs = {
        name: bounded_interval(
            np.array([np.mean([record.metrics[name] for record in records]) for records in runs])
        )
        for name in figures.metric
    }
    return replace(figures, ci95={**figures.ci95, **over_runs})
