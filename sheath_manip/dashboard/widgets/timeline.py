"""The whole episode as a strip: who acted and why, and where a command was limited."""

from collections.abc import Callable
from html import escape
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from sheath_manip.dashboard.changed import set_changed
from sheath_manip.dashboard.markup import TEXT, caption, coloured
from sheath_manip.dashboard.rate_limiter import READ_RATE_HZ, RateLimiter
from sheath_manip.dashboard.snapshot import Snapshot
from sheath_manip.dashboard.widget import WidgetContext
from sheath_manip.playback import palette
from sheath_manip.playback.labels import actor_and_reason_label
from sheath_manip.playback.trace import Trace
from sheath_manip.types import ACTORS, REASONS, Actor, Reason

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
        self._limiter = RateLimiter(READ_RATE_HZ)

    def draw(self, snapshot: Snapshot) -> None:
        """Show the episode as far as it is known."""
        if self._limiter.should_draw(snapshot):
            set_changed(self._strip, content=_strip(snapshot, self._rate_hz))


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
    return _gradient(_codes(trace), _turn_css, steps)


def _limits(trace: Trace, steps: int) -> str:
    if not trace.limited.any():
        return "transparent"
    return _gradient(trace.limited.astype(int), _limit_css, steps)


def _codes(trace: Trace) -> NDArray[np.int64]:
    """(n,) -1 for the policy, others by their reason and who acted: of a bin the largest shows."""
    return np.where(trace.by_policy, -1, trace.reason.astype(int) * len(ACTORS) + trace.actor)


def _who_and_why(code: int) -> tuple[Actor, Reason]:
    reason, actor = divmod(code, len(ACTORS))
    return ACTORS[actor], REASONS[reason]


def _turn_css(code: int) -> str:
    return palette.css(
        palette.ACTOR[Actor.POLICY] if code < 0 else palette.turn(*_who_and_why(code))
    )


def _limit_css(limited: int) -> str:
    return palette.css(palette.LIMITED) if limited else "transparent"


def _gradient(codes: NDArray[np.int64], css: Callable[[int], str], steps: int) -> str:
    """CSS of runs of one colour, each with hard edges: each bin by the largest code in it."""
    stops, length, width = [], len(codes), -(-steps // BINS)
    if length:
        shown = np.maximum.reduceat(codes, np.arange(0, length, width))
        starts = [0, *(np.flatnonzero(np.diff(shown)) + 1).tolist(), len(shown)]
        for start, stop in pairwise(starts):
            begin, end = 100 * start * width / steps, 100 * min(stop * width, length) / steps
            stops.append(f"{css(int(shown[start]))} {begin:.2f}% {end:.2f}%")
    stops.append(f"{EMPTY} {100 * length / steps:.2f}% 100%")
    return f"linear-gradient(to right,{','.join(stops)})"


def _legend(trace: Trace) -> str:
    """What occurred in this episode, in that order."""
    entries: list[tuple[str, palette.Rgb]] = []
    if trace.by_policy.any():
        entries.append(("policy", palette.ACTOR[Actor.POLICY]))
    codes, firsts = np.unique(_codes(trace), return_index=True)
    others = [_who_and_why(code) for code in codes[np.argsort(firsts)].tolist() if code >= 0]
    entries += [(actor_and_reason_label(*why), palette.turn(*why)) for why in others]
    if trace.limited.any():
        entries.append(("command limited", palette.LIMITED))
    return " &nbsp; ".join(
        f'<span style="white-space:nowrap">{coloured("■", colour)} {escape(name)}</span>'
        for name, colour in entries
    )
