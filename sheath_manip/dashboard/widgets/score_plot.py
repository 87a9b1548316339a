"""The gate's score against its threshold over time."""

from html import escape

import numpy as np
from numpy.typing import NDArray
from viser.uplot import Axis, Series

from sheath_manip.dashboard.changed import set_changed
from sheath_manip.dashboard.markup import caption, note
from sheath_manip.dashboard.rate_limiter import READ_RATE_HZ, RateLimiter
from sheath_manip.dashboard.snapshot import Snapshot
from sheath_manip.dashboard.widget import WidgetContext
from sheath_manip.playback import palette
from sheath_manip.types import Actor

HEIGHT_PX = 140
PADDING_PX = (10, 10, 0, 0)
"""top, right, bottom, left: the uppermost number and line are not cut off"""
WINDOW_STEPS = 300
FONT = "12px sans-serif"
AXIS = Axis(
    font=FONT,
    labelFont=FONT,
    stroke=palette.css(palette.GREY),
    ticks={"show": False},
)
SCORE = palette.css((90, 110, 200))
"""stands out on a light page and on a dark one"""
NO_STEP = "No step yet."
NO_SCORE = "There is no score: {method} has no gate that judges what the policy proposes."
LIMITED_BAND = 0.06
"""of the plot's height, along its lower edge"""


class ScorePlot:
    """Score and threshold of the steps around the shown one, and who acted."""

    def __init__(self, context: WidgetContext, ahead: float = 0.0) -> None:
        """`ahead` is the share of the plot that lies after the shown step, 0..1."""
        gui, spec = context.viser.gui, context.spec
        steps = min(WINDOW_STEPS, spec.max_steps)
        self._after = round(ahead * steps)
        self._before = steps - self._after
        window_s = steps / spec.control_rate_hz
        gui.add_html(caption("Support score", "threshold dashed; shaded: the policy does not act"))
        self._no_score = gui.add_html("")
        self._span = gui.add_html("", visible=False)
        self._scores = gui.add_uplot(
            (np.zeros(1),) * 6,
            (
                {"label": "seconds from now"},
                {"label": "score", "stroke": SCORE, "width": 2},
                {
                    "label": "threshold",
                    "stroke": palette.css(palette.GREY),
                    "width": 1.5,
                    "dash": (6, 4),
                },
                _band("the policy does not act", palette.css(palette.ACTOR[Actor.EXPERT]) + "50"),
                _band("command limited", palette.css(palette.LIMITED)),
                _band("now", palette.css(palette.GREY) + ("90" if ahead else "00")),
            ),
            # Ranges that stand still; one that follows the data viser's page now and then loses.
            scales={
                "x": {"time": False, "range": ((ahead - 1) * window_s, ahead * window_s)},
                "band": {"range": (0.0, 1.0)},
            },
            axes=(
                AXIS | Axis(size=28, label="seconds from now", labelSize=18),
                AXIS | Axis(size=44),
            ),
            legend={"show": False},
            height=HEIGHT_PX,
            padding=PADDING_PX,
            visible=False,
        )
        self._limiter = RateLimiter(READ_RATE_HZ)

    def draw(self, snapshot: Snapshot) -> None:
        """Plot the steps around the shown one."""
        if not self._limiter.should_draw(snapshot):
            return
        first = max(snapshot.at - self._before, 0)
        trace = snapshot.trace.until(snapshot.at + 1 + self._after)
        score = trace.score[first:]
        scored = bool(np.isfinite(score).any())
        set_changed(self._scores, visible=scored)
        set_changed(self._span, visible=scored)
        without = NO_SCORE.format(method=escape(snapshot.info.method)) if len(trace) else NO_STEP
        set_changed(self._no_score, visible=not scored, content=note(without))
        if scored:
            # What a click on the plot means.
            first_shown, shown = snapshot.at - self._before, self._before + self._after
            self._span.content = f'<div data-sheath-plot="{first_shown} {shown}"></div>'
            now = np.arange(first, len(trace)) == snapshot.at
            columns: tuple[NDArray, ...] = (
                trace.time_s[first:] - trace.time_s[snapshot.at],
                score,
                trace.threshold[first:],
                ~trace.by_policy[first:],
                LIMITED_BAND * trace.limited[first:],
                now,
            )
            # -inf, which is below any threshold, would leave the plot without a range.
            self._scores.data = tuple(
                np.where(np.isfinite(column), column, np.nan).astype(np.float64)
                for column in columns
            )


def _band(label: str, fill: str) -> Series:
    return Series(label=label, scale="band", fill=fill, width=0, points={"show": False})
