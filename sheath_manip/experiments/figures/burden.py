"""What each method asks of the expert, round by round."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import accumulate
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from sheath_manip.experiments.burdens import STEPS, round_burdens
from sheath_manip.experiments.figures.findings import burden as found
from sheath_manip.experiments.figures.style import (
    GREY,
    drawing,
    drawn_methods,
    heading,
    last_round,
    left_out,
    legend_below,
    looks,
    offsets,
    round_axis,
    round_ticks,
)
from sheath_manip.playback.written import counted, shown


def burden(summary: Mapping[str, Any], path: Path) -> None:
    """Takeovers, seconds of driving and labels, a column each, in every round.

    Above an episode's mean, below what it comes to: how often in a minute, how long at a time, and
    how many labels so far. Of an older summary, which has no control rate, driving is in steps.
    """
    methods, seeds = summary["methods"], len(summary["seeds"])
    rate_hz = summary.get("control_rate_hz")
    with drawing(path, height_px=1100) as figure:
        heading(
            figure,
            found(summary),
            f"{summary['experiment']}, means over {counted(seeds, 'training seed')} with "
            f"{counted(summary['plan']['schedule']['episodes'], 'episode')} a round; round 0 are "
            f"the demonstrations, which all methods share{left_out(methods)}",
        )
        grid = figure.subplots(2, 3)
        panels = _panels(rate_hz)
        names, look_of = drawn_methods(methods), looks(methods)
        for offset, name in zip(offsets(len(names)), names, strict=True):
            rounds = [
                {**entry, **round_burdens(entry, rate_hz)} for entry in methods[name]["rounds"]
            ]
            for axes, panel in zip(grid.ravel(), panels, strict=True):
                entries = rounds if panel.so_far else [each for each in rounds if each["round"] > 0]
                values = _values(entries, panel.key)
                if panel.so_far:
                    values = list(accumulate(values))
                _line(axes, name, look_of[name], offset, entries, values)
        for axes, panel in zip(grid.ravel(), panels, strict=True):
            axes.set_title(panel.title)
            axes.set_ylabel(panel.unit)
            axes.yaxis.set_major_formatter(lambda value, _: f"{value:,.6g}")
            round_ticks(axes.yaxis)
            round_axis(axes, last_round(summary))
            highest = axes.dataLim.y1
            # Room for a marker below the title.
            axes.set_ylim(0, 1.08 * highest if 0 < highest < np.inf else 1.0)
            if not np.isfinite(highest):
                _say_unknown(axes)
        legend_below(figure, grid[0, 0])


@dataclass(frozen=True)
class _Panel:
    key: str
    """of a round's numbers"""
    title: str
    unit: str
    so_far: bool = False
    """added up from the demonstrations on, whose labels the expert gave as well"""


def _panels(rate_hz: float | None) -> list[_Panel]:
    """Two rows of three: a column each for takeovers, driving and labels."""
    driving = (
        _Panel("driving_s_an_episode", "Driving by the expert, per episode", "seconds")
        if rate_hz
        else _Panel(STEPS, "Driving by the expert, per episode", "control steps")
    )
    return [
        _Panel("takeovers_an_episode", "Takeovers per episode", "takeovers"),
        driving,
        _Panel("labels_an_episode", "Labels per episode", "labels"),
        _Panel("takeovers_a_minute", "Takeovers per minute", "takeovers"),
        _Panel("median_takeover_s", "Median takeover", "seconds"),
        _Panel("queries", "Labels so far, per training seed", "labels", so_far=True),
    ]


def _say_unknown(axes: Axes) -> None:
    axes.set_yticks([])
    words = "not counted in this result"
    axes.text(0.5, 0.5, words, transform=axes.transAxes, ha="center", color=GREY)


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
