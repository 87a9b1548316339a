"""A small line chart of methods as SVG text: for what changes seldom, of as many as there are."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from html import escape

import numpy as np
from numpy.typing import NDArray

from sheath_manip.dashboard.chart_numbers import Curve, Form, numbers
from sheath_manip.dashboard.markers import dashes, marker, sample, tone
from sheath_manip.learning.curves import Reading

WIDTH, HEIGHT = 320, 136
LEFT, RIGHT, TOP, BOTTOM = 38, 10, 8, 18
INTERVALS = 3
"""between grid lines, and one more where they do not fit"""
LINE, MARKER, SEED = 2.0, 3.2, 1.5
"""how thick a line is, and the radii of a method's marker and of a seed's dot"""
KEYS = "left and right arrows go from round to round"


def line_chart(title: str, curves: Sequence[Curve], form: Form) -> str:
    """Return `curves` with their intervals as bands, and a dot for each training seed.

    The numbers of each round lie in it as well, for `chart_hover.js` to show; empty where nothing
    is known.
    """
    known = [reading for curve in curves for reading in curve.line.values() if _is_known(reading)]
    if not known:
        return ""
    frame = _Frame.around([number for curve in curves for number in curve.line], known, form.low)
    pieces = [_grid(frame.place(frame.x_low, y)[1], form.tick(y)) for y in frame.ticks]
    for x in sorted({frame.x_low, (frame.x_low + frame.x_high) // 2, frame.x_high}):
        pieces.append(_text(frame.place(x, frame.y_low)[0], HEIGHT - 4, str(x), "middle"))
    pieces.append(_text(LEFT - 4, HEIGHT - 4, "round", "end"))
    # All bands below all lines.
    for draw in (_band, _seeds, _line):
        pieces += [f"<g {tone(curve.look)}>{''.join(draw(curve, frame))}</g>" for curve in curves]
    names = " &nbsp; ".join(
        f'<span style="white-space:nowrap">{sample(curve.look)} {escape(curve.name)}</span>'
        for curve in curves
    )
    rule = f'<line data-sheath-rule y1="{TOP}" y2="{HEIGHT - BOTTOM}" stroke="currentColor"/>'
    rounds = {number for curve in curves for number in curve.line}
    shown = {number: frame.place(number, frame.y_low)[0] for number in sorted(rounds)}
    return (
        f'<div data-sheath-chart tabindex="0" role="group" aria-label="{escape(title)}: {KEYS}">'
        f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" style="width:100%;display:block" font-size="10" '
        f'fill="currentColor" aria-hidden="true">{"".join(pieces)}{rule}</svg>'
        f"{numbers(title, curves, form, shown)}</div><div>{names}</div>"
    )


@dataclass(frozen=True, eq=False)
class _Frame:
    """Where a round and a value lie."""

    x_low: int
    x_high: int
    ticks: NDArray[np.float64]

    @classmethod
    def around(cls, rounds: Sequence[int], known: Sequence[Reading], low: float | None) -> "_Frame":
        values = [each for reading in known for each in _extent(reading)]
        lowest = min(values) if low is None else min(low, *values)
        return cls(min(rounds), max(rounds), _ticks(lowest, max(values)))

    @property
    def y_low(self) -> float:
        return float(self.ticks[0])

    def place(self, x: float, y: float) -> tuple[float, float]:
        across = (x - self.x_low) / max(self.x_high - self.x_low, 1)
        up = (y - self.y_low) / (self.ticks[-1] - self.y_low)
        column = LEFT + MARKER + across * (WIDTH - LEFT - RIGHT - MARKER)
        return column, float(HEIGHT - BOTTOM - up * (HEIGHT - TOP - BOTTOM))


def _is_known(reading: Reading) -> bool:
    return bool(np.isfinite(reading.value))


def _extent(reading: Reading) -> list[float]:
    each = (reading.value, *reading.interval, *reading.seeds.values())
    return [value for value in each if np.isfinite(value)]


def _known(curve: Curve) -> dict[int, Reading]:
    return {number: each for number, each in curve.drawn.items() if _is_known(each)}


def _band(curve: Curve, frame: _Frame) -> Iterator[str]:
    """The intervals; of a single round, a bar."""
    known = _known(curve)
    ends = [
        [frame.place(number, reading.interval[end]) for number, reading in known.items()]
        for end in (0, 1)
    ]
    if len(known) == 1:
        (x, low), (_, high) = ends[0][0], ends[1][0]
        yield (
            f'<line x1="{x:.1f}" x2="{x:.1f}" y1="{low:.1f}" y2="{high:.1f}" stroke="currentColor" '
            'stroke-width="3" opacity=".35"/>'
        )
    elif known:
        path = " ".join(f"{x:.1f},{y:.1f}" for x, y in (*ends[0], *reversed(ends[1])))
        yield f'<polygon points="{path}" fill="currentColor" opacity=".16"/>'


def _seeds(curve: Curve, frame: _Frame) -> Iterator[str]:
    """A dot for each, which where there is only one would lie on the line."""
    for number, reading in _known(curve).items():
        for value in reading.seeds.values() if len(reading.seeds) > 1 else ():
            if np.isfinite(value):
                x, y = frame.place(number, value)
                dot = f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{SEED}"'
                yield f'{dot} fill="currentColor" opacity=".7"/>'


def _line(curve: Curve, frame: _Frame) -> Iterator[str]:
    places = [frame.place(number, reading.value) for number, reading in _known(curve).items()]
    path = " ".join(f"{x:.1f},{y:.1f}" for x, y in places)
    yield (
        f'<polyline points="{path}" fill="none" stroke="currentColor" '
        f'stroke-width="{LINE}" stroke-dasharray="{dashes(curve.look, LINE)}"/>'
    )
    yield from (marker(curve.look, x, y, MARKER) for x, y in places)


def _ticks(low: float, high: float) -> NDArray[np.float64]:
    """Round numbers around `low` .. `high`."""
    rough = (high - low if high - low > 1e-9 else 1.0) / INTERVALS
    power = 10.0 ** np.floor(np.log10(rough))
    step = power * next(each for each in (1, 2, 2.5, 5, 10) if each * power > rough * (1 - 1e-9))
    first, last = np.floor(low / step + 1e-9), np.ceil(high / step - 1e-9)
    return step * np.arange(first, max(last, first + 1) + 1)


def _grid(row: float, tick: str) -> str:
    return (
        f'<line x1="{LEFT}" x2="{WIDTH - RIGHT}" y1="{row:.1f}" y2="{row:.1f}" '
        f'stroke="currentColor" opacity=".15"/>{_text(LEFT - 4, row + 3, tick, "end")}'
    )


def _text(column: float, row: float, text: str, anchor: str) -> str:
    return f'<text x="{column:.1f}" y="{row:.1f}" text-anchor="{anchor}">{text}</text>'
