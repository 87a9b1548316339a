"""How every figure looks: one size, one look a method, round ticks, files equal to the byte."""

from collections.abc import Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager
from math import ceil
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from PIL import Image

from sheath_manip.files.outputs import written_aside
from sheath_manip.playback import palette
from sheath_manip.playback.gif import limited
from sheath_manip.playback.written import capitalised, counted
from sheath_manip.types import Actor

WIDTH_PX = 1600
DPI = 160
TITLE_PT, TITLE_LETTERS = 14.0, 78
"""of a title, and how many of them fit into WIDTH_PX"""
BELOW_PT, BELOW_LETTERS = 9.5, 128
"""the same of the line below it"""

INK, GREY, PALE, PAPER = (
    palette.css(rgb) for rgb in (palette.INK, palette.GREY, palette.PALE, palette.PAPER)
)
POLICY, EXPERT = (palette.css(palette.ACTOR[actor]) for actor in (Actor.POLICY, Actor.EXPERT))
"""the colours of who acts"""
TICK_STEPS = (1, 2, 5, 10)
"""what lies between two ticks, and powers of ten of it"""

SPREAD = 0.44
"""of a round's width, over which the methods stand side by side so that none hides another"""

MOST_METHODS = 6
"""in a panel; the rest is in the table"""
FIRST = (
    "sheath",
    "dagger",
    "random-blocks",
    "sheath-own-labels",
    "hg-dagger",
    "cloning",
    "random-takeover",
)
"""methods that are drawn before others"""
LEGEND_COLUMNS = 5
"""of methods' names that fit beside each other"""

RC: dict[Any, Any] = {
    "font.family": "DejaVu Sans",
    "font.size": 10.0,
    "axes.titlesize": 11.0,
    "axes.titlelocation": "left",
    "axes.titlepad": 8.0,
    "axes.edgecolor": GREY,
    "axes.labelcolor": INK,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.grid.axis": "y",
    "axes.axisbelow": True,
    "grid.color": PALE,
    "grid.linewidth": 0.7,
    "text.color": INK,
    "xtick.color": GREY,
    "ytick.color": GREY,
    "legend.frameon": False,
    "figure.constrained_layout.h_pad": 0.08,
}


@contextmanager
def drawing(path: Path, height_px: int, width_px: int = WIDTH_PX) -> Iterator[Figure]:
    """A figure to draw on, written to `path` at the end. Needs no display and no pyplot."""
    with matplotlib.rc_context(RC):
        figure = Figure(figsize=(width_px / DPI, height_px / DPI), dpi=DPI, layout="constrained")
        canvas = FigureCanvasAgg(figure)
        yield figure
        canvas.draw()
        picture = Image.fromarray(np.asarray(canvas.buffer_rgba())[..., :3])
        # A palette makes a third of the bytes; without metadata the same data give the same file.
        with written_aside(path) as aside:
            limited(picture, 256).save(aside, format="PNG", optimize=True)


def drawn_methods(methods: Iterable[str]) -> list[str]:
    """Return the methods that a panel has room for, in their own order."""
    listed = list(methods)
    ranked = [name for name in FIRST if name in listed]
    ranked += [name for name in listed if name not in FIRST]
    return [name for name in listed if name in ranked[:MOST_METHODS]]


def left_out(methods: Collection[str]) -> str:
    """Return what a subtitle says of the methods that are not drawn; empty where all are."""
    count = len(methods) - min(len(methods), MOST_METHODS)
    return f"; {counted(count, 'more method')} in the table" if count else ""


def looks(names: Iterable[str]) -> dict[str, dict[str, Any]]:
    """Return how matplotlib draws each method's line."""
    return {
        name: {
            "color": palette.css(look.rgb),
            "marker": look.marker,
            "linestyle": (0, look.dashes) if look.dashes else "-",
            "linewidth": 1.8,
        }
        for name, look in palette.methods(names).items()
    }


def legend_below(figure: Figure, axes: Axes) -> None:
    """The legend of `axes` for all of `figure`."""
    handles, labels = axes.get_legend_handles_labels()
    # In rows of equal length where one is not enough.
    columns = ceil(len(labels) / ceil(len(labels) / LEGEND_COLUMNS))
    figure.legend(handles, labels, loc="outside lower center", ncols=columns)


def heading(figure: Figure, title: str, below: str) -> None:
    """Write what the figure found, and below it of what."""
    # What is said is as long as its numbers and names: a longer line is written smaller.
    room = figure.bbox.width / WIDTH_PX
    size_pt = TITLE_PT * min(1.0, TITLE_LETTERS * room / len(title))
    below_pt = BELOW_PT * min(1.0, BELOW_LETTERS * room / len(below))
    figure.suptitle(
        f"{capitalised(title)}\n\n", x=0.012, ha="left", fontsize=size_pt, fontweight="bold"
    )
    top = 1 - 0.40 * DPI / figure.bbox.height
    figure.text(0.012, top, below, fontsize=below_pt, color=GREY, va="top")


def offsets(count: int) -> np.ndarray:
    """(count,) how far beside its round each method is drawn."""
    return SPREAD * (np.arange(count) - (count - 1) / 2) / max(count, 1)


def round_axis(axes: Axes, rounds: int, label: bool = True) -> None:
    """Rounds 0 .. `rounds` along x."""
    axes.set_xlim(-0.5, rounds + 0.5)
    axes.xaxis.set_major_locator(MaxNLocator(11, integer=True, steps=TICK_STEPS))
    # Below markers that stand on the axis.
    axes.tick_params(axis="x", length=0, pad=7)
    if label:
        axes.set_xlabel("round (0: demonstrations)")


def round_ticks(axis: Axis, intervals: int = 6) -> None:
    """Put ticks at round numbers: 1, 2 or 5 times a power of ten apart."""
    axis.set_major_locator(MaxNLocator(intervals, steps=TICK_STEPS))


def percent_axis(axes: Axes) -> None:
    """Shares 0 .. 1 along y, written in per cent."""
    _percent(axes.yaxis)


def percent_axes(axes: Axes) -> None:
    """Shares 0 .. 1 along x and y, written in per cent."""
    _percent(axes.xaxis)
    _percent(axes.yaxis)


def last_round(summary: Mapping[str, Any]) -> int:
    """The highest round that any method has."""
    return max(method["rounds"][-1]["round"] for method in summary["methods"].values())


def _percent(axis: Axis) -> None:
    round_ticks(axis)
    # Six digits leave nothing of a tick out, and bring no rounding of the machine's in.
    axis.set_major_formatter(lambda value, _: f"{100 * value:.6g} %")
