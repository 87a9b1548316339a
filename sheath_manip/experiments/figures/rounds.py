"""Failures and the task's metric by round: while learning, and of the policy alone."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from sheath_manip.experiments.figures.findings import failures
from sheath_manip.experiments.figures.style import (
    INK,
    PAPER,
    capitalised,
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
    quantity,
    round_axis,
    round_ticks,
    shown,
)

FAILURE = "failure_rate"


def rounds(summary: Mapping[str, Any], path: Path) -> None:
    """Above: what really ran in each round and in all. Below: each round's policy alone."""
    metric = summary["metric"]
    plan = summary["plan"]
    name = quantity(metric)
    with drawing(path, height_px=1150) as figure:
        heading(
            figure,
            failures(summary),
            f"{summary['experiment']}, {counted(len(summary['seeds']), 'training seed')} with "
            f"{counted(plan['schedule']['episodes'], 'episode')} a round; each policy alone on "
            f"{counted(plan['comparison']['evaluation_episodes'], 'held-out scene')}; "
            f"bars are 95 % intervals{left_out(summary['methods'])}",
        )
        grid = figure.subplots(2, 4, width_ratios=(6, 1.1, 6, 1.1))
        for column, figure_name in ((0, FAILURE), (2, metric)):
            above, below = grid[0, column], grid[1, column]
            _by_round(above, summary, "executed", figure_name, first=1)
            _by_round(below, summary, "policy", figure_name, first=0)
            _pooled(grid[0, column + 1], summary, "overall", figure_name)
            _pooled(grid[1, column + 1], summary, "final", figure_name)
        shared = [grid[0, :2], grid[1, :2], grid[0, 2:]]
        # Another final variant is on a scale of its own, such as three laps instead of one.
        same = plan["schedule"]["variant"] == plan["comparison"]["final_variant"]
        for panels in (*shared, grid[1, 2:]) if same else (*shared, grid[1, 2:3], grid[1, 3:]):
            _fit_height(list(panels))
        if same:
            _as_beside(grid[1, 3])
            grid[1, 3].set_xlabel("last\npolicy")
        for axes in grid[:, 0]:
            axes.set_ylabel("episodes failed")
        for axes in grid[:, 2]:
            axes.set_ylabel(name)
        grid[0, 0].set_title("Failed episodes while learning, under the gate")
        grid[0, 2].set_title(f"{capitalised(name)} while learning, under the gate")
        grid[1, 0].set_title("Failed episodes of the policy alone")
        grid[1, 2].set_title(f"{capitalised(name)} of the policy alone")
        legend_below(figure, grid[0, 0])


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
    if figure_name == FAILURE:
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
    if figure_name == FAILURE or what == "overall":
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
    value = figures[FAILURE] if name == FAILURE else figures["metric"].get(name)
    if value is None:
        return np.nan, np.nan, np.nan
    low, high = figures["ci95"][name]
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
