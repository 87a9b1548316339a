"""The benchmark's two figures: ROC curves, and failures against the expert's share."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from sheath_manip.experiments.figures.style import (
    BLUE,
    GREEN,
    GREY,
    INK,
    ORANGE,
    OTHERS,
    VERMILLION,
    drawing,
    heading,
    percent_axes,
)
from sheath_manip.experiments.gates.offline import CURVE
from sheath_manip.experiments.gates.rows import EXPERT, POLICY, RANDOM
from sheath_manip.experiments.gates.setting import Setting
from sheath_manip.experiments.gates.summary import offline_of
from sheath_manip.experiments.gates.table import by_costly_mistakes
from sheath_manip.experiments.table import seeds_shown

SHARES_SHOWN = 0.6
"""of the steps; beyond it the expert drives, and nothing fails"""


def draw(settings: Sequence[Setting], summary: Mapping[str, Any], directory: Path) -> list[Path]:
    """Write both figures of every task, and give their paths."""
    written = []
    plan = summary["plan"]
    for task, found in summary["tasks"].items():
        curves = {
            name: offline_of([at for at in settings if at.task.name == task], name)["curves"]
            for name, row in found["rows"].items()
            if "auroc" in row
        }
        paths = [directory / f"{task}-{kind}.png" for kind in ("roc", "share")]
        roc(task, found, curves, plan, paths[0])
        failures_by_share(task, found, plan, paths[1])
        written += paths
    return written


def roc(
    task: str,
    found: Mapping[str, Any],
    curves: Mapping[str, Mapping[str, Sequence[float]]],
    plan: Mapping[str, Any],
    path: Path,
) -> None:
    """Left: states where no expert comes. Right: costly mistakes of the policy."""
    looks = highlighted(found)
    rows = found["rows"]
    with drawing(path, height_px=1000) as figure:
        heading(
            figure,
            f"{task.capitalize()}: what the gates notice",
            f"{len(curves)} gates on the same policy and states; {plan['visited']} held-out scenes "
            f"with the policy alone, training seeds {seeds_shown(plan['seeds'])}",
        )
        panels = figure.subplots(1, 2)
        for axes, kind in zip(panels, ("far", "costly"), strict=True):
            lines = {name: np.array(curve[kind], float) for name, curve in curves.items()}
            for name in lines.keys() - looks:
                axes.plot(CURVE, lines[name], color=GREY, alpha=0.3, linewidth=1)
            for height, (name, (colour, said)) in enumerate(reversed(looks.items())):
                axes.plot(CURVE, lines[name], color=colour, linewidth=2.2, label=f"{said}: {name}")
                row = rows[name]
                area = row["auroc_far"] if kind == "far" else row["errs"]["costly"]
                said_area = "–" if area is None else f"{area:.3f}"
                place = (0.98, 0.05 + 0.055 * height)
                axes.annotate(said_area, place, ha="right", color=colour)
            axes.plot([0, 1], [0, 1], color=INK, linewidth=1, linestyle=(0, (4, 3)), label="chance")
            axes.set_xlim(0, 1)
            axes.set_ylim(0, 1.005)
            axes.grid(visible=True, axis="both")
            percent_axes(axes)
        panels[0].set_title("Displaced to where no expert comes")
        panels[1].set_title("The policy makes a costly mistake")
        panels[0].set_ylabel("share of the displaced states outside")
        panels[1].set_ylabel("share of the mistakes outside")
        panels[0].set_xlabel("share of new expert states outside (numbers: areas under curves)")
        panels[1].set_xlabel("share of the policy's other states outside")
        handles, labels = panels[0].get_legend_handles_labels()
        # In the order of the numbers, from above; chance last.
        order = [*reversed(range(len(looks))), len(looks)]
        handles, labels = [handles[i] for i in order], [labels[i] for i in order]
        figure.legend(handles, labels, loc="outside lower center", ncols=2)


def failures_by_share(
    task: str, found: Mapping[str, Any], plan: Mapping[str, Any], path: Path
) -> None:
    """Draw how often a gate fails while the expert acts in so many of the steps."""
    rows, looks = found["rows"], highlighted(found)
    with drawing(path, height_px=1000) as figure:
        heading(
            figure,
            f"{task.capitalize()}: what the gates save, by what they ask of the expert",
            f"the same policy on the same scenes, {plan['episodes']} for each threshold of a "
            f"coloured gate, {plan['other_episodes']} or as many of a grey one; bars are 95 % "
            "intervals",
        )
        axes = figure.subplots()
        alone = rows[POLICY]["loop"]["points"][0]
        driven = {name: row for name, row in rows.items() if row["loop"] is not None}
        for name, row in driven.items():
            if name not in looks and name not in (POLICY, EXPERT, RANDOM):
                shares, rates, *_ = _curve(row["loop"])
                axes.plot(shares, rates, color=GREY, alpha=0.3, linewidth=1, marker=".", zorder=1)
        _bars(axes, rows[RANDOM]["loop"], ORANGE, "^", "random takeover", alone)
        markers = ("o", *(marker for _, marker in OTHERS))
        for (name, (colour, said)), marker in zip(looks.items(), markers * 9, strict=False):
            if name not in driven:
                continue
            _bars(axes, rows[name]["loop"], colour, marker, f"{said}: {name}", alone)
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
        axes.set_xlim(-0.01, SHARES_SHOWN)
        axes.set_ylim(bottom=0)
        percent_axes(axes)
        axes.set_xlabel("steps in which the expert acted")
        axes.set_ylabel("episodes failed")
        figure.legend(loc="outside lower center", ncols=2)


def highlighted(found: Mapping[str, Any]) -> dict[str, tuple[str, str]]:
    """Colour and role of the gates worth telling apart: the default, the best other, the worst, and
    those with more than one signal."""
    rows = by_costly_mistakes({name: row for name, row in found["rows"].items() if "errs" in row})
    default = found["default"]
    looks: dict[str, tuple[str, str]] = {}
    if default in rows:
        looks[default] = (BLUE, "default")
    others = [name for name in rows if name != default]
    if others:
        looks[others[0]] = (GREEN, "best other")
        looks.setdefault(others[-1], (VERMILLION, "worst"))
    joined = [name for name in others if len(rows[name]["signals"]) > 1]
    for name, (colour, _) in zip(joined, OTHERS[1:] * len(joined), strict=False):
        looks.setdefault(name, (colour, "joined"))
    return looks


def _bars(
    axes: Axes,
    loop: Mapping[str, Any],
    colour: str,
    marker: str,
    label: str,
    alone: Mapping[str, Any],
) -> None:
    """A gate's points with their intervals, joined to the policy alone."""
    shares, rates, low, high = _curve(loop)
    axes.vlines(shares, low, high, color=colour, alpha=0.3, linewidth=2.2)
    start = alone["executed"]["failure_rate"]
    axes.plot([0, *shares], [start, *rates], color=colour, linewidth=1.2, alpha=0.6)
    axes.plot(shares, rates, marker, color=colour, markersize=6.5, clip_on=False, label=label)


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
