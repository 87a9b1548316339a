"""The gate's score against its threshold over time."""

import numpy as np
from viser.uplot import Axis

from sheath_manip.dashboard import palette
from sheath_manip.dashboard.markup import caption, note
from sheath_manip.dashboard.moment import Moment
from sheath_manip.dashboard.part import Desk
from sheath_manip.dashboard.tally import HISTORY_STEPS, Scored
from sheath_manip.types import Actor

HEIGHT_PX = 140
FONT = "12px sans-serif"
AXIS = Axis(
    font=FONT,
    labelFont=FONT,
    stroke=palette.css(palette.GREY),
    ticks={"show": False},
)
LIMITED_BAND = 0.06
"""of the plot's height, along its lower edge"""


class ScorePlot:
    """Score and threshold of the latest steps, and who acted."""

    def __init__(self, desk: Desk) -> None:
        gui, spec = desk.viser.gui, desk.spec
        window_s = min(HISTORY_STEPS, spec.max_steps) / spec.control_rate_hz
        gui.add_html(caption("Support score", "threshold dashed, expert's turns shaded"))
        self._no_score = gui.add_html(note("This gate computes no score."))
        self._scores = gui.add_uplot(
            (np.zeros(1),) * len(Scored._fields),
            (
                {"label": "seconds from now"},
                {"label": "score", "stroke": palette.css(palette.INK), "width": 2},
                {
                    "label": "threshold",
                    "stroke": palette.css(palette.GREY),
                    "width": 1.5,
                    "dash": (6, 4),
                },
                {
                    "label": "expert acts",
                    "scale": "expert",
                    "fill": palette.css(palette.ACTOR[Actor.EXPERT]) + "50",
                    "width": 0,
                    "points": {"show": False},
                },
                {
                    "label": "command limited",
                    "scale": "expert",
                    "fill": palette.css(palette.LIMITED),
                    "width": 0,
                    "points": {"show": False},
                },
            ),
            # Ranges that stand still; one that follows the data viser's page now and then loses.
            scales={
                "x": {"time": False, "range": (-window_s, 0.0)},
                "expert": {"range": (0.0, 1.0)},
            },
            axes=(
                AXIS | Axis(size=28, label="seconds from now", labelSize=18),
                AXIS | Axis(size=44),
            ),
            legend={"show": False},
            height=HEIGHT_PX,
            visible=False,
        )

    def draw(self, moment: Moment) -> None:
        """Plot the latest steps."""
        columns = np.asarray(moment.scores, dtype=np.float64).reshape(-1, len(Scored._fields)).T
        scored = bool(np.isfinite(columns[1]).any())
        self._scores.visible, self._no_score.visible = scored, not scored
        if scored:
            columns[0] -= columns[0, -1]
            columns[Scored._fields.index("limited")] *= LIMITED_BAND
            self._scores.data = tuple(np.ascontiguousarray(column) for column in columns)
