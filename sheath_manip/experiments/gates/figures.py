"""The benchmark's two figures: what gates notice, and failures against the expert's share."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patheffects import withStroke
from matplotlib.transforms import offset_copy

from sheath_manip.experiments.figures.style import (
    GREY,
    INK,
    drawing,
    heading,
    looks,
    percent_axes,
    round_ticks,
)
from sheath_manip.experiments.gates.rows import EXPERT, POLICY, RANDOM
from sheath_manip.experiments.gates.summary import NOTICED
from sheath_manip.experiments.gates.table import by_costly_mistakes
from sheath_manip.experiments.table import seeds_shown
from sheath_manip.playback.written import in_percent

SHARE = "share"
"""what the other figure's name ends in"""
CHANCE = 0.5
"""area under the curve of a score that knows nothing"""
MISTAKES = {"costly": "Costly mistakes", "differs": "Other actions than the expert's"}
"""by what is measured of them"""
SHARES_SHOWN = 0.6
"""of the steps; beyond it the expert drives, and nothing fails"""


def draw(summary: Mapping[str, Any], directory: Path) -> list[Path]:
    """Write both figures of every task, and give their paths."""
    written = []
    for task, found in summary["tasks"].items():
        for kind, figure in ((NOTICED, noticed), (SHARE, failures_by_share)):
            written.append(directory / f"{task}-{kind}.png")
            figure(task, found, summary["plan"], written[-1])
    return written


def noticed(task: str, found: Mapping[str, Any], plan: Mapping[str, Any], path: Path) -> None:
    """Draw one point a gate: how well it tells apart what no expert does, and costly mistakes."""
    named = highlighted(found)
    measured = _measured(found["rows"])
    places = {
        name: (row["auroc_far"], row["errs"][measured])
        for name, row in found["rows"].items()
        if "errs" in row and None not in (row["auroc_far"], row["errs"][measured])
    }
    middle = np.mean([place[0] for place in places.values()] or [CHANCE])
    areas = [f"{places[name][1]:.2f}" for name in named if name in places] or ["–"]
    with drawing(path, height_px=1000) as figure:
        heading(
            figure,
            f"{MISTAKES[measured]}: {found['default']} notices them with an area of {areas[0]}, "
            f"the worst of {len(places)} gates with {areas[-1]}",
            f"{task}; all gates on the same policy and {plan['visited']} held-out scenes, training "
            f"seeds {seeds_shown(plan['seeds'])}; grey: the others, by name in the table",
        )
        axes = figure.subplots()
        look_of = _looks(named)
        for name in sorted(places.keys() - named.keys()):
            axes.plot(*places[name], "o", color=GREY, alpha=0.35, markersize=7)
        for number, name in enumerate(each for each in named if each in places):
            look = look_of[name]
            axes.plot(*places[name], **look, markersize=13, zorder=3, clip_on=False)
            # Good gates lie close to each other: their names one below the other, to the left.
            x, y = places[name]
            left = x > middle
            shift = (-14, 14 - 22 * number) if left else (14, 12)
            place = offset_copy(axes.transData, figure, *shift, units="points")
            axes.text(
                x,
                y,
                f"{named[name]}: {name}",
                transform=place,
                ha="right" if left else "left",
                va="center",
                fontsize=13,
                path_effects=[withStroke(linewidth=4, foreground="white")],
                zorder=4,
            )
        lowest = min([CHANCE, *(each for place in places.values() for each in place)]) - 0.01
        axes.set_xlim(lowest, 1.01)
        axes.set_ylim(lowest, 1.01)
        axes.grid(visible=True, axis="both")
        round_ticks(axes.xaxis)
        round_ticks(axes.yaxis)
        axes.tick_params(labelsize=12)
        axes.set_xlabel("area under the curve: displaced to where no expert comes", fontsize=13)
        axes.set_ylabel(
            f"area under the curve: {MISTAKES[measured].lower()} of the policy", fontsize=13
        )


def _measured(rows: Mapping[str, Any]) -> str:
    """Costly mistakes, or where the policy made none, any action that is not the expert's."""
    found = (row["errs"]["costly"] for row in rows.values() if "errs" in row)
    return "costly" if any(area is not None for area in found) else "differs"


def failures_by_share(
    task: str, found: Mapping[str, Any], plan: Mapping[str, Any], path: Path
) -> None:
    """Draw how often a gate fails while the expert acts in so many of the steps."""
    rows, named = found["rows"], highlighted(found)
    driven = {name: named.get(name, "") for name in (*named, RANDOM) if rows[name]["loop"]}
    alone = rows[POLICY]["loop"]["points"][0]
    default = min(
        rows[found["default"]]["loop"]["points"],
        key=lambda point: abs(point["expert_share"] - plan["share"]),
    )
    with drawing(path, height_px=1000) as figure:
        heading(
            figure,
            f"{found['default']} fails in {_failed(default)} scenes with the expert in "
            f"{in_percent(default['expert_share'])} of the steps, the policy alone in "
            f"{_failed(alone)}",
            f"{task}; the same policy on the same {plan['episodes']} scenes for each threshold; "
            "bars are 95 % intervals; the other gates are in the table",
        )
        axes = figure.subplots()
        look_of = _looks(named)
        for name, role in driven.items():
            label = f"{role}: {name}" if role else name.replace("-", " ")
            _bars(axes, rows[name]["loop"], look_of[name], label, alone)
        executed = alone["executed"]
        low, high = executed["ci95"]["failure_rate"]
        axes.vlines(0, low, high, color=INK, alpha=0.4, linewidth=2.2)
        axes.plot(0, executed["failure_rate"], "s", color=INK, label="policy alone", clip_on=False)
        level = rows[EXPERT]["loop"]["points"][0]["executed"]["failure_rate"]
        axes.axhline(level, color=INK, linewidth=1, linestyle=(0, (4, 3)), label="expert alone")
        axes.axvline(plan["share"], color=GREY, linewidth=1, zorder=0)
        axes.annotate(
            " compared here",
            (plan["share"], 0.99),
            xycoords=("data", "axes fraction"),
            color=GREY,
            va="top",
        )
        axes.set_xlim(-0.01, min(1.1 * axes.dataLim.x1, SHARES_SHOWN))
        axes.set_ylim(0, 1.05 * axes.dataLim.y1)
        percent_axes(axes)
        axes.set_xlabel("steps in which the expert acted")
        axes.set_ylabel("episodes failed")
        figure.legend(loc="outside lower center", ncols=2)


def highlighted(found: Mapping[str, Any]) -> dict[str, str]:
    """Role of the gates worth telling apart, three at most: the default, the best other one, the
    worst. With random takeover they are as many as a panel holds."""
    rows = by_costly_mistakes({name: row for name, row in found["rows"].items() if "errs" in row})
    default = found["default"]
    named = {default: "default"} if default in rows else {}
    others = [name for name in rows if name != default]
    if others:
        named[others[0]] = "best other"
        named.setdefault(others[-1], "worst")
    return named


def _looks(named: Mapping[str, str]) -> dict[str, dict[str, Any]]:
    """The default is drawn as SHEATH is, which it is the gate of."""
    like = dict(zip(named, ("sheath", "best other", "dagger"), strict=False)) | {RANDOM: RANDOM}
    return {name: looks(like.values())[of] for name, of in like.items()}


def _bars(
    axes: Axes,
    loop: Mapping[str, Any],
    look: Mapping[str, Any],
    label: str,
    alone: Mapping[str, Any],
) -> None:
    """A gate's points with their intervals, joined to the policy alone."""
    shares, rates, low, high = _curve(loop)
    axes.vlines(shares, low, high, color=look["color"], alpha=0.3, linewidth=2.2)
    start = alone["executed"]["failure_rate"]
    axes.plot([0, *shares], [start, *rates], **{**look, "marker": ""}, alpha=0.6)
    axes.plot(shares, rates, **{**look, "linestyle": ""}, markersize=7, clip_on=False, label=label)


def _failed(point: Mapping[str, Any]) -> str:
    executed = point["executed"]
    return f"{round(executed['failure_rate'] * executed['episodes'])} of {executed['episodes']}"


def _curve(loop: Mapping[str, Any]) -> np.ndarray:
    """(4, points) expert share, failure rate and its interval."""
    points = sorted(loop["points"], key=lambda point: point["expert_share"])
    return np.array(
        [
            (
                point["expert_share"],
                point["executed"]["failure_rate"],
                *point["executed"]["ci95"]["failure_rate"],
            )
            for point in points
        ]
    ).T
