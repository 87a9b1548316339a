"""Who acts and why, in large letters."""

from html import escape

import numpy as np

from sheath_manip.dashboard import palette
from sheath_manip.dashboard.markup import BOX
from sheath_manip.dashboard.moment import Moment
from sheath_manip.dashboard.part import Desk
from sheath_manip.types import Actor, GateDecision, Outcome


class Banner:
    """Who acts, for which reason, at which score; or how the episode ended."""

    def __init__(self, desk: Desk) -> None:
        self._box = desk.viser.gui.add_html(_banner(None, None))

    def draw(self, moment: Moment) -> None:
        """Show the latest decision."""
        self._box.content = _banner(
            None if moment.step is None else moment.step.decision, moment.outcome
        )


def _banner(decision: GateDecision | None, outcome: Outcome | None) -> str:
    if decision is None:
        colour, title, below = palette.GREY, "Waiting", "for the first step"
    else:
        colour = palette.turn(decision.actor is Actor.EXPERT, decision.reason)
        title = f"{decision.actor.value.capitalize()} acts"
        below = decision.reason.value
        if np.isfinite(decision.score) and np.isfinite(decision.threshold):
            sign = "≥" if decision.score >= decision.threshold else "<"
            below += f" · score {decision.score:.2f} {sign} {decision.threshold:.2f}"
    if outcome is not None:
        colour, title, below = palette.OUTCOME[outcome], outcome.value.capitalize(), "episode over"
    return (
        f'<div style="{BOX};background:{palette.css(colour)}">'
        f'<div style="font-size:1.7em;font-weight:700">{escape(title)}</div>{escape(below)}</div>'
    )
