"""The whole episode as a strip: who acted and why, and where a command was limited."""

from html import escape

import numpy as np
from numpy.typing import NDArray

from sheath_manip.dashboard.markup import TEXT, caption, coloured
from sheath_manip.dashboard.snapshot import Snapshot
from sheath_manip.dashboard.widget import WidgetContext
from sheath_manip.playback import palette
from sheath_manip.playback.labels import actor_and_reason_label
from sheath_manip.playback.trace import Trace
from sheath_manip.types import ACTORS, REASONS, Actor

BINS = 240
"""at most: more are finer than the strip's pixels"""
GROWTH_STEPS = 150
"""the strip of a running episode has room for so many more, so that it does not creep"""
EMPTY = "#80808022"


class Timeline:
    """The strip, its legend, and a mark at the shown step."""

    def __init__(self, context: WidgetContext) -> None:
        self._rate_hz = context.spec.control_rate_hz
        context.viser.gui.add_html(caption("Timeline", "who acted and why; click to look there"))
        self._strip = context.viser.gui.add_html("")

    def draw(self, snapshot: Snapshot) -> None:
        """Show the episode as far as it is known."""
        self._strip.content = _strip(snapshot, self._rate_hz)


def _strip(snapshot: Snapshot, rate_hz: float) -> str:
    trace = snapshot.trace
    ended = snapshot.outcome is not None or not snapshot.present
    steps = len(trace) if ended else GROWTH_STEPS * (len(trace) // GROWTH_STEPS + 1)
    steps = max(steps, 1)
    mark = 100 * (snapshot.at + 1) / steps
    return (
        f'<div style="{TEXT}">'
        f'<div data-sheath-span="0 {steps}" style="position:relative;padding-top:6px">'
        f'<div style="height:18px;border-radius:3px;background:{_turns(trace, steps)}"></div>'
        f'<div style="height:4px;margin-top:2px;background:{_limits(trace, steps)}"></div>'
        f'<div style="position:absolute;top:0;left:{mark:.2f}%;width:2px;height:30px;'
        f'background:currentColor"></div></div>'
        f'<div style="display:flex;justify-content:space-between;opacity:.6"><span>0 s</span>'
        f"<span>{round(steps / rate_hz, 1):g} s</span></div>{_legend(trace)}</div>"
    )


def _turns(trace: Trace, steps: int) -> str:
    """Colour each bin by its last step, but where the policy did not act at all in it, by why."""
    width = -(-steps // BINS)
    # Policy steps are -1, others their reason's place and who acted: so the largest one shows.
    codes = np.where(trace.by_policy, -1, trace.reason.astype(int) * len(ACTORS) + trace.actor)
    edges = np.arange(0, len(codes), width)
    shown = np.maximum.reduceat(codes, edges) if len(codes) else codes
    colours = [palette.css(_colour(int(code))) for code in shown]
    return _gradient(colours, width, len(trace), steps)


def _colour(code: int) -> palette.Rgb:
    if code < 0:
        return palette.ACTOR[Actor.POLICY]
    reason, actor = divmod(code, len(ACTORS))
    return palette.turn(ACTORS[actor], REASONS[reason])


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
    if trace.by_policy.any():
        entries.append(("policy", palette.ACTOR[Actor.POLICY]))
    others = np.flatnonzero(~trace.by_policy)
    occurred = dict.fromkeys(trace.who_and_why(step) for step in others.tolist())
    entries += [(actor_and_reason_label(*why), palette.turn(*why)) for why in occurred]
    if trace.limited.any():
        entries.append(("command limited", palette.LIMITED))
    return " &nbsp; ".join(
        f'<span style="white-space:nowrap">{coloured("■", colour)} {escape(name)}</span>'
        for name, colour in entries
    )
