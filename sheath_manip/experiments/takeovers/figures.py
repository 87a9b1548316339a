"""The benchmark's figures: what fails by how often, and by how much, the expert is called."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes

from sheath_manip.experiments.figures.style import (
    GREY,
    INK,
    drawing,
    heading,
    looks,
    percent_axes,
    percent_axis,
    round_ticks,
)
from sheath_manip.experiments.takeovers.plan import BASELINES_OF, TAKEOVERS
from sheath_manip.experiments.takeovers.table import NAMES
from sheath_manip.playback.written import in_percent

LIKE = ("sheath", "random-takeover", "dagger", "cloning")
"""methods in whose colours they are drawn"""


def draw(summary: Mapping[str, Any], results: Path) -> list[Path]:
    """Draw one figure a task and axis; returns their paths."""
    paths = []
    for task, found in summary["tasks"].items():
        for axis in dict.fromkeys(target["axis"] for target in found["targets"]):
            path = results / f"{task}-{axis}.png"
            _by_burden(task, axis, found, path)
            paths.append(path)
    return paths


def _by_burden(task: str, axis: str, found: Mapping[str, Any], path: Path) -> None:
    targets = [target for target in found["targets"] if target["axis"] == axis]
    scenes = targets[0]["ways"]["gate"]["scenes"]
    # The burden that a person can live with: one call an episode, or the nearest there is to it.
    told = min(targets, key=lambda each: abs(each["value"] - (1.0 if axis == TAKEOVERS else 0.08)))
    gate, other = (told["ways"][name] for name in ("gate", BASELINES_OF[axis][0]))
    with drawing(path, height_px=1000) as figure:
        heading(
            figure,
            f"{task}: the gate leaves {gate['failed']} of {scenes} scenes failing at "
            f"{_asked(gate, axis)}, {NAMES[BASELINES_OF[axis][0]].strip()} {other['failed']} at "
            f"{_asked(other, axis)}",
            "scenes in which the policies fail alone, fresh ones, each way on the same; bars are "
            "95 % intervals by scene; gate and threshold were chosen on other scenes",
        )
        axes = figure.subplots()
        for name, look in zip(("gate", *BASELINES_OF[axis]), looks(LIKE).values(), strict=False):
            _curve(axes, axis, targets, name, look)
        oracle = found["oracle"]
        if oracle is not None and oracle["scenes"]:
            axes.plot(
                _burden_of(oracle, axis),
                oracle["rate"],
                "*",
                color=INK,
                markersize=13,
                label=f"oracle, {oracle['scenes']} of the scenes",
                clip_on=False,
            )
        axes.set_ylim(0, 1.02)
        axes.set_xlim(left=0)
        axes.grid(visible=True, axis="both")
        if axis == TAKEOVERS:
            percent_axis(axes)
            round_ticks(axes.xaxis)
            axes.set_xlabel("takeovers an episode")
        else:
            percent_axes(axes)
            axes.set_xlabel("steps in which the expert acted")
        axes.set_ylabel("scenes that still fail")
        axes.axhline(1, color=GREY, linewidth=0.8)
        figure.legend(loc="outside lower center", ncols=3)


def _burden_of(way: Mapping[str, Any], axis: str) -> float:
    """What is held equal, as it came out."""
    return way["burden"]["takeovers_an_episode"] if axis == TAKEOVERS else way["expert_share"]


def _asked(way: Mapping[str, Any], axis: str) -> str:
    """The burden as words."""
    burden = _burden_of(way, axis)
    return f"{burden:.1f} takeovers" if axis == TAKEOVERS else f"{in_percent(burden)} share"


def _curve(axes: Axes, axis: str, targets: list[Any], name: str, look: dict[str, Any]) -> None:
    """One way over all its burdens, from the policy alone on."""
    ways = sorted(
        (target["ways"][name] for target in targets), key=lambda way: _burden_of(way, axis)
    )
    burdens = [_burden_of(way, axis) for way in ways]
    rates = [way["rate"] for way in ways]
    low, high = zip(*(way["ci95"] for way in ways), strict=True)
    axes.vlines(burdens, low, high, color=look["color"], alpha=0.35, linewidth=2.2)
    axes.plot([0, *burdens], [1, *rates], **{**look, "marker": ""}, alpha=0.6)
    label = NAMES[name].strip()
    axes.plot(burdens, rates, **{**look, "linestyle": ""}, markersize=7, label=label)
