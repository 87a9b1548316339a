"""The numbers behind a chart, one piece of HTML a round, which the page's script shows in a box."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from html import escape

import numpy as np

from sheath_manip.dashboard.markers import sample
from sheath_manip.learning.curves import Line, Reading
from sheath_manip.playback.palette import Look
from sheath_manip.playback.written import counted, in_percent

DASH = "–"
MOST_SEEDS = 12
"""of which each value is said"""


@dataclass(frozen=True)
class Curve:
    """One line of a chart."""

    name: str
    """as it is written for people"""
    look: Look
    line: Line
    start: Line = field(default_factory=dict)
    """that the line is drawn on from, and that is another curve's as well"""

    @property
    def drawn(self) -> Line:
        """All that the line goes through."""
        return {**self.start, **self.line}


@dataclass(frozen=True)
class Form:
    """How a quantity is drawn and written."""

    is_share: bool = True
    """written in per cent"""
    low: float | None = 0.0
    """that the axis holds, whatever the values are"""

    def tick(self, value: float) -> str:
        """Return a number of the axis."""
        return f"{100 * value:.6g} %" if self.is_share else f"{value:.6g}"

    def value(self, value: float) -> str:
        """Return a mean."""
        if not np.isfinite(value):
            return DASH
        return in_percent(value) if self.is_share else f"{value:.3g}"

    def interval(self, interval: tuple[float, float]) -> str:
        """Return the two ends of an interval."""
        if not np.isfinite(interval).all():
            return DASH
        if not self.is_share:
            return DASH.join(f"{end:.3g}" for end in interval)
        return f"{DASH.join(f'{100 * end:.0f}' for end in interval)} %"


def numbers(title: str, curves: Sequence[Curve], form: Form, places: Mapping[int, float]) -> str:
    """Return what is to be said of each round of `places`, which says where it is drawn."""
    return "".join(
        f'<template data-sheath-round="{place:.1f}"><b>{escape(title)}, round {number}</b>'
        f"<small>mean, and its 95 % interval</small>{_rows(curves, form, number)}</template>"
        for number, place in places.items()
    )


def _rows(curves: Sequence[Curve], form: Form, number: int) -> str:
    return "".join(
        f"<div>{sample(curve.look)} {escape(curve.name)} {_said(curve.line[number], form)}</div>"
        for curve in curves
        if number in curve.line
    )


def _said(reading: Reading, form: Form) -> str:
    """Mean, interval and episodes, and below them each seed's."""
    if not np.isfinite(reading.value):
        return DASH
    mean = (
        f"<b>{form.value(reading.value)}</b> ({form.interval(reading.interval)}), "
        f"{counted(reading.episodes, 'episode')}"
    )
    if len(reading.seeds) > MOST_SEEDS:
        return f"{mean}<small>{len(reading.seeds)} seeds</small>"
    each = " · ".join(f"{seed}: {form.value(value)}" for seed, value in reading.seeds.items())
    return f"{mean}<small>{'seed' if len(reading.seeds) == 1 else 'seeds'} {each}</small>"
