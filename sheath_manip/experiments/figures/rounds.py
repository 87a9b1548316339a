"""How episodes ended and the task's metric by round: while learning, and of the policy alone."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from sheath_manip.experiments.figures.findings import failures
from sheath_manip.experiments.figures.style import (
    INK,
    PAPER,
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
)
from sheath_manip.metrics import ENDED, endings
from sheath_manip.playback.written import capitalised, counted, quantity, shown
from sheath_manip.types import Outcome

ROWS = (Outcome.FAILURE, Outcome.TIME_LIMIT, Outcome.SUCCESS)
"""how an episode ends: a row each, above that of the task's metric"""
RATES = {ENDED[each]: each for each in ROWS}
"""by the word; what is none of them is the name of a metric"""


def rounds(summary: Mapping[str, Any], path: Path) -> None:
    """Left: what really ran in each round and in all. Right: each round's policy alone."""
    metric = summary["metric"]
    plan = summary["plan"]
    name = quantity(metric)
    # Of a task whose metric is its success nothing is shown twice.
    shown_rows = (*RATES, *([metric] if _tells_more(summary) else []))
    with drawing(path, height_px=200 + 450 * len(shown_rows)) as figure:
        heading(
            figure,
            failures(summary),
            f"{summary['experiment']}, {counted(len(summary['seeds']), 'training seed')} with "
            f"{counted(plan['schedule']['episodes'], 'episode')} a round; each policy alone on "
            f"{counted(plan['comparison']['evaluation_episodes'], 'held-out scene')}; "
            f"bars are 95 % intervals{left_out(summary['methods'])}",
        )
        grid = figure.subplots(len(shown_rows), 4, width_ratios=(6, 1.3, 6, 1.3))
        # Another final variant is on a scale of its own, such as three laps instead of one.
        same = plan["schedule"]["variant"] == plan["comparison"]["final_variant"]
        for row, figure_name in zip(grid, shown_rows, strict=True):
            learning, all_rounds, alone, final = row
            _by_round(learning, summary, "executed", figure_name, first=1)
            _pooled(all_rounds, summary, "overall", figure_name)
            _by_round(alone, summary, "policy", figure_name, first=0)
            _pooled(final, summary, "final", figure_name)
            _fit_height([learning, all_rounds])
            if same or figure_name in RATES:
                _fit_height([alone, final])
                _as_beside(final)
            else:
                _fit_height([alone])
                _fit_height([final])
            if same:
                final.set_xlabel("last\npolicy")
            what = capitalised(figure_name if figure_name in RATES else name)
            learning.set_title(f"{what} while learning, under the gate")
            alone.set_title(f"{what}: the policy alone")
            for axes in (learning, alone):
                axes.set_ylabel("share of episodes" if figure_name in RATES else name)
        legend_below(figure, grid[0, 0])


def _tells_more(summary: Mapping[str, Any]) -> bool:
    """Whether the metric differs from the rate of success."""
    figures = [method["overall"] for method in summary["methods"].values()]
    return any(each["metric"].get(summary["metric"]) != each["success_rate"] for each in figures)


def _by_round(
    axes: Axes, summary: Mapping[str, Any], what: str, figure_name: str, first: int
) -> None:
    """One line a method from round `first` on, with its intervals, and the expert's level."""
    methods = summary["methods"]
    names, look_of = drawn_methods(methods), looks(methods)
    for offset, name in zip(offsets(len(names)), names, strict=True):
        points = [
            (
                entry["round"] + (offset if entry["round"] else 0.0),
                *_point(entry[what], figure_name),
            )
            for entry in methods[name]["rounds"]
            if entry["round"] >= first
        ]
        x, value, low, high = np.array(points, dtype=float).T
        look = look_of[name]
        axes.vlines(x, low, high, color=look["color"], alpha=0.4, linewidth=2.2)
        axes.plot(x, value, **look, markersize=5, clip_on=False, zorder=3, label=shown(name))
        if first == 0:
            # Every method starts from this one policy.
            axes.plot(0, value[0], "o", color=INK, markersize=6, zorder=4)
    _expert(axes, summary, figure_name)
    round_axis(axes, last_round(summary))
    if figure_name in RATES:
        percent_axis(axes)
    else:
        round_ticks(axes.yaxis)


def _pooled(axes: Axes, summary: Mapping[str, Any], what: str, figure_name: str) -> None:
    """All rounds in one, or the last policies on the final variant: one point a method."""
    methods = summary["methods"]
    names, look_of = drawn_methods(methods), looks(methods)
    for position, name in enumerate(names):
        value, low, high = _point(methods[name][what], figure_name)
        look = look_of[name]
        axes.vlines(position, low, high, color=look["color"], alpha=0.4, linewidth=3.5)
        axes.plot(position, value, **look, markersize=6.5, clip_on=False)
    if what == "overall":
        _expert(axes, summary, figure_name)
    axes.set_xlim(-0.8, len(names) - 0.2)
    axes.set_xticks([])
    axes.set_xlabel({"overall": "all\nrounds", "final": "final\nvariant"}[what])
    axes.set_facecolor(PAPER)
    round_ticks(axes.yaxis)
    if what == "overall":
        _as_beside(axes)


def _as_beside(axes: Axes) -> None:
    """Without an axis, since it is on the scale of the panel beside it."""
    axes.tick_params(axis="y", length=0, labelleft=False)
    axes.spines["left"].set_visible(False)


def _expert(axes: Axes, summary: Mapping[str, Any], figure_name: str) -> None:
    level, *_ = _point(summary["expert"], figure_name)
    axes.axhline(level, color=INK, linewidth=1, linestyle=(0, (4, 3)), label="expert alone")


def _point(figures: Mapping[str, Any], name: str) -> tuple[float, float, float]:
    """A figure and its interval; NaN, which is not drawn, where there is none."""
    if name in RATES:
        value, interval = endings(figures)[name]
    else:
        value, interval = figures["metric"].get(name), figures["ci95"].get(name)
    if value is None or interval is None:
        return np.nan, np.nan, np.nan
    low, high = interval
    return value, low, high


def _fit_height(panels: Sequence[Axes]) -> None:
    """One range for panels of one quantity, which holds all points and is never below 0."""
    limits = [axes.dataLim for axes in panels]
    low, high = min(limit.y0 for limit in limits), max(limit.y1 for limit in limits)
    if not np.isfinite([low, high]).all():
        low, high = 0.0, 1.0
    # Of equal points there is still something to see below, and no tick above what is possible.
    low = min(low, 0.9 * high)
    margin = 0.06 * max(high - low, 0.1)
    for axes in panels:
        axes.set_ylim(max(low - margin, 0.0), high + margin)
