"""A small line chart of methods as SVG text: for what changes seldom, of as many as there are."""

from collections.abc import Mapping, Sequence
from html import escape

import numpy as np
from numpy.typing import NDArray

from sheath_manip.playback import palette

WIDTH, HEIGHT = 320, 130
LEFT, RIGHT, TOP, BOTTOM = 38, 8, 8, 18
INTERVALS = 3
"""between grid lines, and one more where they do not fit"""
_MARKS = {"o": "●", "s": "■", "D": "◆", "^": "▲", "v": "▼", "P": "✚", "X": "✖", "<": "◀", "*": "★"}
"""a method's marker as a letter"""

Points = Sequence[tuple[float, float]]


def line_chart(lines: Mapping[str, Points], low: float | None = None) -> str:
    """The `lines` by method, over a range that holds them all, and `low` where it is given."""
    known = [(x, y) for points in lines.values() for x, y in points if np.isfinite(y)]
    if not known:
        return ""
    x_low, x_high = min(x for x, _ in known), max(x for x, _ in known)
    y_low, y_high = min(y for _, y in known), max(y for _, y in known)
    ticks = _ticks(y_low if low is None else min(low, y_low), y_high)
    y_low, y_high = ticks[0], ticks[-1]

    def place(x: float, y: float) -> tuple[float, float]:
        across = (x - x_low) / max(x_high - x_low, 1e-9)
        up = (y - y_low) / (y_high - y_low)
        return LEFT + across * (WIDTH - LEFT - RIGHT), HEIGHT - BOTTOM - up * (
            HEIGHT - TOP - BOTTOM
        )

    pieces = [_grid(y, *place(x_low, y)) for y in ticks]
    for x in sorted({round(x_low), round((x_low + x_high) / 2), round(x_high)}):
        column, _ = place(x, y_low)
        pieces.append(_text(column, HEIGHT - 4, f"{x:g}", "middle"))
    looks = palette.methods(lines)
    for name, points in lines.items():
        look = looks[name]
        colour, dashes = palette.css(look.rgb), " ".join(f"{2 * each:g}" for each in look.dashes)
        placed = [place(x, y) for x, y in points if np.isfinite(y)]
        path = " ".join(f"{x:.1f},{y:.1f}" for x, y in placed)
        pieces.append(
            f'<polyline points="{path}" fill="none" stroke="{colour}" '
            f'stroke-width="2" stroke-dasharray="{dashes or "none"}"/>'
        )
        pieces += [
            f'<circle cx="{x:.1f}" cy="{y:.1f}" r="2.5" fill="{colour}"/>' for x, y in placed
        ]
    names = " &nbsp; ".join(
        f'<span style="white-space:nowrap"><span style="color:'
        f'{palette.css(looks[name].rgb)}">{_MARKS.get(looks[name].marker, "●")}</span> '
        f"{escape(name)}</span>"
        for name in lines
    )
    return (
        f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" style="width:100%" '
        f'font-size="10" fill="currentColor">{"".join(pieces)}</svg><div>{names}</div>'
    )


def _ticks(low: float, high: float) -> NDArray[np.float64]:
    """Round numbers around `low` .. `high`."""
    rough = (high - low if high - low > 1e-9 else 1.0) / INTERVALS
    power = 10.0 ** np.floor(np.log10(rough))
    step = power * next(each for each in (1, 2, 2.5, 5, 10) if each * power > rough * (1 - 1e-9))
    first, last = np.floor(low / step + 1e-9), np.ceil(high / step - 1e-9)
    return step * np.arange(first, max(last, first + 1) + 1)


def _grid(value: float, column: float, row: float) -> str:
    return (
        f'<line x1="{column:.1f}" x2="{WIDTH - RIGHT}" y1="{row:.1f}" y2="{row:.1f}" '
        f'stroke="currentColor" opacity=".15"/>{_text(column - 4, row + 3, f"{value:.3g}", "end")}'
    )


def _text(column: float, row: float, text: str, anchor: str) -> str:
    return f'<text x="{column:.1f}" y="{row:.1f}" text-anchor="{anchor}">{text}</text>'
