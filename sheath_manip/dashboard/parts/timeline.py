"""The whole episode as a strip: who acted and why, and where a command was limited."""

from html import escape

import numpy as np
from numpy.typing import NDArray

from sheath_manip.dashboard.markup import TEXT, caption
from sheath_manip.dashboard.moment import Moment
from sheath_manip.dashboard.part import Desk
from sheath_manip.playback import palette
from sheath_manip.playback.labels import acting_and_why
from sheath_manip.playback.trace import REASONS, Trace
from sheath_manip.types import Reason

BINS = 240
"""at most: more are finer than the strip's pixels"""
GROWTH_STEPS = 150
"""the strip of a running episode has room for so many more, so that it does not creep"""
EMPTY = "#80808022"


class Timeline:
    """The strip, its legend, and a mark at the shown step."""

    def __init__(self, desk: Desk) -> None:
        self._rate_hz = desk.spec.control_rate_hz
        desk.viser.gui.add_html(caption("Timeline", "who acted and why"))
        self._strip = desk.viser.gui.add_html("")

    def draw(self, moment: Moment) -> None:
        """Show the episode as far as it is known."""
        self._strip.content = _strip(moment, self._rate_hz)


def _strip(moment: Moment, rate_hz: float) -> str:
    trace = moment.trace
    ended = moment.outcome is not None or not moment.present
    steps = len(trace) if ended else GROWTH_STEPS * (len(trace) // GROWTH_STEPS + 1)
    steps = max(steps, 1)
    mark = 100 * (moment.at + 1) / steps
    return (
        f'<div style="{TEXT}"><div style="position:relative;padding-top:6px">'
        f'<div style="height:18px;border-radius:3px;background:{_turns(trace, steps)}"></div>'
        f'<div style="height:4px;margin-top:2px;background:{_limits(trace, steps)}"></div>'
        f'<div style="position:absolute;top:0;left:{mark:.2f}%;width:2px;height:30px;'
        f'background:currentColor"></div></div>'
        f'<div style="display:flex;justify-content:space-between;opacity:.6"><span>0 s</span>'
        f"<span>{steps / rate_hz:.0f} s</span></div>{_legend(trace)}</div>"
    )


def _turns(trace: Trace, steps: int) -> str:
    """Of each bin the colour of its last step, but the expert's where it acted at all in it."""
    width = -(-steps // BINS)
    # Policy steps are 0, the expert's 1 + place of the reason: so the largest one shows.
    codes = np.where(trace.by_expert, 1 + trace.reason.astype(int), 0)
    edges = np.arange(0, len(codes), width)
    shown = np.maximum.reduceat(codes, edges) if len(codes) else codes
    colours = [palette.css(palette.turn(code > 0, REASONS[max(code - 1, 0)])) for code in shown]
    return _gradient(colours, width, len(trace), steps)


def _limits(trace: Trace, steps: int) -> str:
    width = -(-steps // BINS)
    edges = np.arange(0, len(trace), width)
    shown: NDArray = np.logical_or.reduceat(trace.limited, edges) if len(trace) else trace.limited
    if not shown.any():
        return "transparent"
    colours = [palette.css(palette.LIMITED) if each else "transparent" for each in shown]
    return _gradient(colours, width, len(trace), steps)


def _gradient(colours: list[str], width: int, length: int, steps: int) -> str:
    """CSS of runs of one colour, each with hard edges."""
    stops, start = [], 0
    for index in range(1, len(colours) + 1):
        if index == len(colours) or colours[index] != colours[start]:
            begin, end = 100 * start * width / steps, 100 * min(index * width, length) / steps
            stops.append(f"{colours[start]} {begin:.2f}% {end:.2f}%")
            start = index
    stops.append(f"{EMPTY} {100 * length / steps:.2f}% 100%")
    return f"linear-gradient(to right,{','.join(stops)})"


def _legend(trace: Trace) -> str:
    """What occurred in this episode."""
    entries: list[tuple[str, palette.Rgb]] = []
    if not trace.by_expert.all():
        entries.append(("policy", palette.turn(False, Reason.INSIDE)))
    occurred = np.unique(trace.reason[trace.by_expert])
    entries += [
        (acting_and_why(True, REASONS[code]), palette.turn(True, REASONS[code]))
        for code in occurred
    ]
    if trace.limited.any():
        entries.append(("command limited", palette.LIMITED))
    return " &nbsp; ".join(
        f'<span style="white-space:nowrap"><span style="color:{palette.css(colour)}">■</span> '
        f"{escape(name)}</span>"
        for name, colour in entries
    )
