"""What each method asks of the expert, round by round."""

from collections.abc import Mapping, Sequence
from itertools import accumulate
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from sheath_manip.experiments.figures.findings import burden as found
from sheath_manip.experiments.figures.style import (
    counted,
    drawing,
    drawn_methods,
    heading,
    last_round,
    left_out,
    legend_below,
    looks,
    offsets,
    percent_axis,
    round_axis,
    round_ticks,
    shown,
)


def burden(summary: Mapping[str, Any], path: Path) -> None:
    """Expert share, switches, and the labels of a training run: per round and up to it."""
    methods, seeds = summary["methods"], len(summary["seeds"])
    with drawing(path, height_px=1100) as figure:
        heading(
            figure,
            found(summary),
            f"{summary['experiment']}, means over {counted(seeds, 'training seed')} with "
            f"{counted(summary['plan']['schedule']['episodes'], 'episode')} a round; round 0 are "
            f"the demonstrations, which all methods share{left_out(methods)}",
        )
        grid = figure.subplots(2, 2)
        share, switches, queries, total = grid.ravel()
        names, look_of = drawn_methods(methods), looks(methods)
        for offset, name in zip(offsets(len(names)), names, strict=True):
            look = look_of[name]
            entries = methods[name]["rounds"]
            learning = [entry for entry in entries if entry["round"] > 0]
            _line(share, name, look, offset, learning, _values(learning, "expert_share"))
            _line(switches, name, look, offset, learning, _values(learning, "switches_per_episode"))
            _line(queries, name, look, offset, learning, _values(learning, "queries"))
            # From the demonstrations on, whose labels the expert gave as well.
            up_to = list(accumulate(_values(entries, "queries")))
            _line(total, name, look, offset, entries, up_to)
        share.set_title("Steps in which the expert acted")
        switches.set_title("Changes of who acts, per episode")
        queries.set_title("Labels asked in the round, per training seed")
        total.set_title("Labels asked so far, per training seed")
        for axes, unit in zip(
            grid.ravel(), ("share of steps", "switches", "labels", "labels"), strict=True
        ):
            axes.set_ylabel(unit)
        for axes in (queries, total):
            axes.yaxis.set_major_formatter(lambda value, _: f"{value:,.0f}")
        for axes in grid.ravel():
            round_ticks(axes.yaxis)
            # Room for a marker below the title.
            axes.set_ylim(0, 1.08 * axes.dataLim.y1 or 1.0)
            round_axis(axes, last_round(summary))
        percent_axis(share)
        legend_below(figure, share)


def _line(
    axes: Axes,
    name: str,
    look: Mapping[str, Any],
    offset: float,
    entries: Sequence[Mapping[str, Any]],
    values: Sequence[float],
) -> None:
    number = [entry["round"] + offset for entry in entries]
    axes.plot(number, values, **look, markersize=5.5, clip_on=False, zorder=3, label=shown(name))


def _values(entries: Sequence[Mapping[str, Any]], key: str) -> list[float]:
    return [np.nan if entry[key] is None else entry[key] for entry in entries]
