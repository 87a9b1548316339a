"""The figures of an experiment: one line in FIGURES each, whatever the task."""

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import UnknownNameError
from sheath_manip.experiments.figures.bound import bound
from sheath_manip.experiments.figures.burden import burden
from sheath_manip.experiments.figures.film import film
from sheath_manip.experiments.figures.film_strip import film_strip
from sheath_manip.experiments.figures.intervention import (
    AS_RECORDED,
    NothingToShowError,
    View,
    best_intervention,
)
from sheath_manip.experiments.figures.rounds import rounds
from sheath_manip.experiments.figures.talk import talk
from sheath_manip.experiments.summary import TALK

OF_SUMMARIES: dict[str, Callable[[Mapping[str, Any], Path], None]] = {
    TALK: talk,
    "rounds.png": rounds,
    "burden.png": burden,
    "bound.png": bound,
}
"""by file name, those that need nothing but the summary"""
FIGURES: dict[str, Callable[[Mapping[str, Any], EpisodeStore, View, Path], None]] = {
    **{
        name: lambda summary, _, __, path, draw=draw: draw(summary, path)
        for name, draw in OF_SUMMARIES.items()
    },
    "film_strip.png": lambda _, store, view, path: film_strip(
        best_intervention(store, view=view), path
    ),
    "intervention.gif": lambda _, store, view, path: film(
        best_intervention(store, view=view), path
    ),
}
"""by file name, from the summary, the episodes and how their steps look"""

TaskFigures = Mapping[str, Callable[[Path], None]]
"""A task's own figures, with their store, checkpoint and environment bound already."""


def write_figures(
    directory: Path,
    summary: Mapping[str, Any],
    store: EpisodeStore,
    task_figures: TaskFigures | None = None,
    names: Iterable[str] | None = None,
    view: View = AS_RECORDED,
) -> list[Path]:
    """Write the figures `names`, or all, into `directory` and give their paths in that order.

    A figure whose episodes are not in the store, such as an intervention where nobody intervened,
    is left out. Raises UnknownNameError before anything is written.
    """
    table: dict[str, Callable[[Path], None]] = {
        name: lambda path, draw=draw: draw(summary, store, view, path)
        for name, draw in FIGURES.items()
    }
    table |= task_figures or {}
    wanted = list(table if names is None else names)
    for name in wanted:
        if name not in table:
            raise UnknownNameError("figure", name, table)
    written = []
    for name in wanted:
        path = directory / name
        try:
            table[name](path)
        except NothingToShowError:
            # A stale file of an earlier run would be taken for this one's.
            path.unlink(missing_ok=True)
        else:
            written.append(path)
    return written


__all__ = [
    "FIGURES",
    "OF_SUMMARIES",
    "NothingToShowError",
    "TaskFigures",
    "View",
    "bound",
    "burden",
    "film",
    "film_strip",
    "rounds",
    "talk",
    "write_figures",
]
