"""How every figure looks: one size, one colour and one marker a method, files equal to the byte."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

from sheath_manip.outputs import written_aside

WIDTH_PX = 1600
DPI = 160

# Okabe and Ito, which colour-blind readers can tell apart; the marker says it a second time.
BLUE, VERMILLION, ORANGE, GREEN, PURPLE, SKY = (
    "#0072B2",
    "#D55E00",
    "#E69F00",
    "#009E73",
    "#CC79A7",
    "#56B4E9",
)
# Not theirs: dark enough beside their orange and vermillion.
BROWN = "#7a4a1e"
INK, GREY, PALE = "#22272e", "#6e747c", "#d9dce1"
POLICY, EXPERT = BLUE, VERMILLION
"""the colours of who acts"""

SPREAD = 0.44
"""of a round's width, over which the methods stand side by side so that none hides another"""

METHODS = {
    "cloning": (GREY, "D"),
    "dagger": (VERMILLION, "s"),
    "sheath": (BLUE, "o"),
    "random-takeover": (ORANGE, "^"),
}
OTHERS = ((GREEN, "v"), (PURPLE, "P"), (SKY, "X"), (BROWN, "<"), (INK, "*"))
"""for methods that have no colour of their own, in their order; with METHODS' nine in all"""
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


def limited(picture: Image.Image, colours: int, palette: Image.Image | None = None) -> Image.Image:
    """`picture` in its own best `colours`, or in those of `palette`."""
    # Coverage keeps what is small and bright, such as a car; k-means then what is large.
    method, refinements = Image.Quantize.MAXCOVERAGE, 3
    return picture.quantize(colours, method, refinements, palette, Image.Dither.NONE)


def looks(names: list[str]) -> dict[str, tuple[str, str]]:
    """Colour and marker of each method, the same in all figures of an experiment."""
    others = [name for name in names if name not in METHODS]
    spare = {name: OTHERS[index % len(OTHERS)] for index, name in enumerate(others)}
    return {name: METHODS.get(name) or spare[name] for name in names}


def shown(name: str) -> str:
    """A method's name as its authors write it."""
    written = {
        "sheath": "SHEATH",
        "sheath-own-labels": "SHEATH, own labels",
        "sheath-plain": "SHEATH as in the draft",
        "dagger": "DAgger",
        "dagger-beta": "DAgger with β",
        "hg-dagger": "HG-DAgger",
        "lazy-dagger": "LazyDAgger",
        "thrifty-dagger": "ThriftyDAgger",
        "smile": "SMILe",
        "shiv": "SHIV's queries",
        "cloning": "behaviour cloning",
    }
    return written.get(name, name.replace("-", " "))


def quantity(metric: str) -> str:
    """A metric as an axis calls it: `distance_tiles` is a distance in tiles."""
    name, _, unit = metric.rpartition("_")
    return f"{name.replace('_', ' ')} ({unit})" if name else unit


def counted(count: int, what: str) -> str:
    """`1 episode`, `2 episodes`."""
    return f"{count} {what}" if count == 1 else f"{count} {what}s"


def legend_below(figure: Figure, axes: Axes) -> None:
    """The legend of `axes` for all of `figure`."""
    handles, labels = axes.get_legend_handles_labels()
    columns = min(len(labels), LEGEND_COLUMNS)
    figure.legend(handles, labels, loc="outside lower center", ncols=columns)


def heading(figure: Figure, title: str, below: str) -> None:
    """Return a heading: what the figure shows, and of what."""
    figure.suptitle(f"{title}\n\n", x=0.012, ha="left", fontsize=14, fontweight="bold")
    figure.text(
        0.012, 1 - 0.40 * DPI / figure.bbox.height, below, fontsize=9.5, color=GREY, va="top"
    )


def offsets(count: int) -> np.ndarray:
    """(count,) how far beside its round each method is drawn."""
    return SPREAD * (np.arange(count) - (count - 1) / 2) / max(count, 1)


def round_axis(axes: Axes, rounds: int, label: bool = True) -> None:
    """Rounds 0 .. `rounds` along x."""
    axes.set_xlim(-0.5, rounds + 0.5)
    axes.set_xticks(range(rounds + 1))
    axes.tick_params(axis="x", length=0)
    if label:
        axes.set_xlabel("round (0: demonstrations)")


def percent_axis(axes: Axes) -> None:
    """Shares 0 .. 1 along y, written in per cent."""
    axes.yaxis.set_major_formatter(_percent)


def percent_axes(axes: Axes) -> None:
    """Shares 0 .. 1 along x and y, written in per cent."""
    axes.xaxis.set_major_formatter(_percent)
    axes.yaxis.set_major_formatter(_percent)


def last_round(summary: Mapping[str, Any]) -> int:
    """The highest round that any method has."""
    return max(method["rounds"][-1]["round"] for method in summary["methods"].values())


def _percent(value: float, _: float) -> str:
    return f"{100 * value:.0f} %"
