"""The one figure for a talk: how often robots failed while learning, against the expert's share."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from matplotlib.transforms import offset_copy

from sheath_manip.experiments.figures.findings import OVERALL, rates, talked_about
from sheath_manip.experiments.figures.style import (
    drawing,
    drawn_methods,
    heading,
    left_out,
    looks,
    percent_axes,
)
from sheath_manip.playback.written import counted, shown

NAME_PT = 15.0
EXPERT_ALONE = 0.98
"""share of the steps from which on a name stands to the left of its point"""


def talk(summary: Mapping[str, Any], path: Path) -> None:
    """Draw one point a method, with its name beside it; the best place is the lower left corner."""
    methods = summary["methods"]
    what = talked_about(summary)
    learning = what == OVERALL
    episodes = max(method[what]["episodes"] for method in methods.values())
    with drawing(path, height_px=900) as figure:
        heading(
            figure,
            rates(summary),
            f"{summary['experiment']}, {'all rounds' if learning else 'last policies'} of "
            f"{counted(len(summary['seeds']), 'training run')}: {episodes:,} episodes a method; "
            f"bars are 95 % intervals{left_out(methods)}",
        )
        axes = figure.subplots()
        look_of = looks(methods)
        for name in drawn_methods(methods):
            figures, look = methods[name][what], look_of[name]
            share, rate = methods[name]["overall"]["expert_share"], figures["failure_rate"]
            low, high = figures["ci95"]["failure_rate"]
            axes.vlines(share, low, high, color=look["color"], alpha=0.4, linewidth=6)
            axes.plot(share, rate, **look, markersize=13, clip_on=False, zorder=3)
            left = share > EXPERT_ALONE
            place = offset_copy(axes.transData, figure, -14 if left else 14, 9, units="points")
            axes.text(
                share,
                rate,
                shown(name),
                transform=place,
                ha="right" if left else "left",
                fontsize=NAME_PT,
                fontweight="bold",
            )
        percent_axes(axes)
        axes.set_xlim(-0.02, 1.02)
        axes.set_ylim(0, 1.1 * axes.dataLim.y1 or 1.0)
        # Below the markers that stand on the axis.
        axes.tick_params(labelsize=12, pad=9)
        axes.set_xlabel("steps in which the expert acted", fontsize=NAME_PT)
        failed = "episodes that failed while learning" if learning else "final scenes failed, alone"
        axes.set_ylabel(failed, fontsize=NAME_PT)
