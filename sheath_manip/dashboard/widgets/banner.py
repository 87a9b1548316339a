"""Who acts and why, in large letters."""

from html import escape

import numpy as np

from sheath_manip.cockpit import Cockpit
from sheath_manip.cockpit.cockpit import State
from sheath_manip.dashboard.changed import set_changed
from sheath_manip.dashboard.markup import BOX
from sheath_manip.dashboard.snapshot import Snapshot
from sheath_manip.dashboard.widget import WidgetContext
from sheath_manip.playback import palette
from sheath_manip.playback.labels import FALLBACK, actor_label, score_label
from sheath_manip.types import Actor, GateDecision, Reason


class Banner:
    """Who acts, for which reason, at which score; or how the episode ended."""

    def __init__(self, context: WidgetContext, cockpit: Cockpit | None = None) -> None:
        """`cockpit` is a live run's: while that stands still, its last step tells nothing."""
        self._cockpit = cockpit
        self._box = context.viser.gui.add_html(_box(palette.GREY, "waiting", "for the first step"))

    def draw(self, snapshot: Snapshot) -> None:
        """Show the latest decision."""
        state = None if self._cockpit is None else self._cockpit.state
        if snapshot.outcome is not None:
            colour = palette.OUTCOME[snapshot.outcome]
            set_changed(self._box, content=_box(colour, snapshot.outcome.value, "episode over"))
        elif state is not None and snapshot.present and _stands_still(state):
            reason = Reason.EMERGENCY_STOP if state.stopped else Reason.WAITING
            set_changed(self._box, content=_held(reason))
        elif snapshot.step is not None:
            fallback = FALLBACK if state is None else state.fallback
            set_changed(self._box, content=_banner(snapshot.step.decision, fallback))


def _stands_still(state: State) -> bool:
    """Whether nothing moves until a person says so; a car's last step was somebody else's."""
    return state.turn is Actor.HOLD and (state.stopped or state.asking)


def _held(reason: Reason) -> str:
    label = actor_label(Actor.HOLD, reason)
    return _box(palette.turn(Actor.HOLD, reason), label, reason.value)


def _banner(decision: GateDecision, fallback: str) -> str:
    actor, reason = decision.actor, decision.reason
    below = reason.value
    if np.isfinite(decision.score) and np.isfinite(decision.threshold):
        below += f" · {score_label(decision.score, decision.threshold)}"
    return _box(palette.turn(actor, reason), actor_label(actor, reason, fallback), below)


def _box(colour: palette.Rgb, title: str, below: str) -> str:
    ink = palette.css(palette.readable_on(colour))
    title = escape(title[:1].upper() + title[1:])
    return (
        f'<div style="{BOX};color:{ink};background:{palette.css(colour)}">'
        f'<div style="font-size:1.7em;font-weight:700">{title}</div>{escape(below)}</div>'
    )
