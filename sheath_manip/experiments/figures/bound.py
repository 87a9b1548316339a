"""Theorem 4.2 by round: what bounds the mistakes of an episode, and how many there were."""

from collections.abc import Mapping
from math import ceil
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from sheath_manip.experiments.figures.findings import bound as found
from sheath_manip.experiments.figures.style import (
    INK,
    drawing,
    drawn_methods,
    heading,
    last_round,
    left_out,
    round_axis,
    round_ticks,
)
from sheath_manip.playback.written import counted, shown

PANELS = 4
"""that stand beside each other"""
FIT, OUTSIDE = "#9aa1ab", "#56B4E9"


def bound(summary: Mapping[str, Any], path: Path) -> None:
    """Draw one panel a method: T (epsilon_N + xi) as a sum of two parts, and the measured J."""
    methods = {name: summary["methods"][name] for name in drawn_methods(summary["methods"])}
    rows = ceil(len(methods) / PANELS)
    columns = ceil(len(methods) / rows)
    with drawing(path, height_px=300 + 420 * rows) as figure:
        heading(
            figure,
            found(summary),
            f"{summary['experiment']}; a mistake is a step at which the policy's action is not the "
            f"expert's; means over {counted(len(summary['seeds']), 'training seed')}"
            f"{left_out(summary['methods'])}",
        )
        grid = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False).ravel()
        for axes in grid[len(methods) :]:
            axes.set_visible(False)
        for axes, (name, method) in zip(grid, methods.items(), strict=False):
            _parts(axes, method["rounds"])
            axes.set_title(shown(name))
            round_axis(axes, last_round(summary), label=False)
            axes.set_xlabel("round")
        # Once for all panels: they share the axis, and the first alone would cut the others off.
        round_ticks(grid[0].yaxis)
        grid[0].set_ylim(0, 1.08 * _highest(methods))
        for axes in grid[::columns]:
            axes.set_ylabel("control steps of an episode")
        handles, labels = grid[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))


def _highest(methods: Mapping[str, Any]) -> float:
    values = [
        entry[key]
        for method in methods.values()
        for entry in method["rounds"]
        for key in ("bound", "measured")
    ]
    return max((value for value in values if value is not None), default=0.0) or 1.0


def _parts(axes: Axes, rounds: list[Mapping[str, Any]]) -> None:
    keys = ("round", "bound", "epsilon", "xi", "measured")
    number, value, epsilon, xi, measured = np.array(
        [[entry[key] for key in keys] for entry in rounds], dtype=float
    ).T
    # Seeds differ in T, so the mean bound is split in proportion and not computed anew.
    fit = value * np.divide(epsilon, epsilon + xi, out=np.zeros_like(xi), where=epsilon + xi > 0)
    axes.bar(number, fit, width=0.8, color=FIT, label="T ε: fitting error")
    axes.bar(number, value - fit, 0.8, bottom=fit, color=OUTSIDE, label="T ξ: outside the support")
    axes.plot(number, measured, color=INK, marker="o", markersize=5, label="measured J")
