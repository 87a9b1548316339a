"""The benchmark's figure of a task: what lies outside the support, and how fast one learns."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import to_hex

from sheath_manip.experiments.figures.style import (
    INK,
    drawing,
    heading,
    legend_below,
    offsets,
    percent_axis,
    round_axis,
    round_ticks,
)
from sheath_manip.playback.written import capitalised, counted, in_percent, quantity

MARKERS = "osDv^P*X"
LINES = 3
"""by round: the smallest support, the largest, and one between them"""


def draw(summary: Mapping[str, Any], directory: Path) -> list[Path]:
    """Write the figure of every task, and give their paths."""
    written = []
    for task, found in summary["tasks"].items():
        written.append(directory / f"{task}-nu.png")
        nu_figure(task, found, written[-1])
    return written


def nu_figure(task: str, found: Mapping[str, Any], path: Path) -> None:
    """Above by round, a line for each nu; below against nu, all rounds in one."""
    rows, metric = found["nus"], found["metric"]
    name, seeds = quantity(metric), len(found["learning"]["comparison"]["seeds"])
    with drawing(path, height_px=1100) as figure:
        heading(
            figure,
            _finding(rows, metric),
            f"{task}, {counted(seeds, 'training seed')}; ν bounds the training states that the "
            "support leaves outside; the gate is its own boundary; "
            "bars are 95 % intervals",
        )
        grid = figure.subplots(2, 2)
        shades = colormaps["viridis"](np.linspace(0.0, 0.85, len(rows)))
        beside = offsets(len(rows))
        lines = set(np.linspace(0, len(rows) - 1, LINES).astype(int).tolist())
        for index, (row, shade) in enumerate(zip(rows, shades, strict=True)):
            marker = MARKERS[index % len(MARKERS)]
            look = {"color": to_hex(shade), "marker": marker, "label": f"ν = {row['nu']:g}"}
            if index in lines:
                learning = row["rounds"][1:]
                number = [entry["round"] + beside[index] for entry in learning]
                grid[0, 0].plot(number, [entry["xi"] for entry in learning], **look)
                _with_bars(grid[0, 1], row["rounds"], metric, beside[index], look)
            area = row["area"]["policy"]
            grid[1, 0].plot(row["nu"], row["outside"], markersize=8, **look)
            grid[1, 1].vlines(row["nu"], *area["ci95"], color=look["color"], alpha=0.4, linewidth=3)
            grid[1, 1].plot(row["nu"], area["mean"], markersize=8, **look)
        nus = [row["nu"] for row in rows]
        grid[1, 0].plot(nus, nus, color=INK, linewidth=1, linestyle=(0, (4, 3)), zorder=1)
        grid[1, 0].annotate("ν itself", (nus[-1], nus[-1]), ha="right", va="bottom", color=INK)
        for axes in grid[0]:
            round_axis(axes, rows[0]["rounds"][-1]["round"])
        for axes in grid[1]:
            _nu_axis(axes, nus)
        grid[0, 0].set_title("Steps outside the support, where the expert acts")
        grid[0, 1].set_title(f"{capitalised(name)} of the policy alone")
        grid[1, 0].set_title("Steps outside, all rounds")
        grid[1, 1].set_title("Policy alone, mean over all rounds (area)")
        for axes in grid[:, 1]:
            axes.set_ylabel(name)
        for axes in grid.flat:
            round_ticks(axes.yaxis)
            # Room for a marker: values close to each other leave none of their own.
            axes.set_ylim(0, 1.08 * axes.dataLim.y1 or 1.0)
        for axes in grid[:, 0]:
            axes.set_ylabel("share of steps")
            percent_axis(axes)
        legend_below(figure, grid[0, 0])


def _finding(rows: Sequence[Mapping[str, Any]], metric: str) -> str:
    """What the smallest and the largest support did, from their numbers."""
    first, last = rows[0], rows[-1]
    shares = [in_percent(row["outside"]) for row in (first, last)]
    means = [f"{row['area']['policy']['mean']:.3g}" for row in (first, last)]
    return (
        f"From ν = {first['nu']:g} to {last['nu']:g} the expert acts in {shares[0]} to {shares[1]} "
        f"of the steps; {quantity(metric)} of the policy alone: {means[0]} to {means[1]}"
    )


def _with_bars(
    axes: Axes,
    rounds: Sequence[Mapping[str, Any]],
    metric: str,
    offset: float,
    look: Mapping[str, Any],
) -> None:
    number = [entry["round"] + offset for entry in rounds]
    values = [entry["policy"]["metric"][metric] for entry in rounds]
    low, high = np.array([entry["policy"]["ci95"][metric] for entry in rounds], float).T
    axes.vlines(number, low, high, color=look["color"], alpha=0.4, linewidth=2.2)
    axes.plot(number, values, **look)


def _nu_axis(axes: Axes, nus: Sequence[float]) -> None:
    axes.set_xscale("log")
    axes.set_xticks(nus, [f"{nu:g}" for nu in nus])
    axes.set_xticks([], minor=True)
    axes.set_xlabel("ν")
