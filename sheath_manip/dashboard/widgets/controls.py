"""The controls: emergency stop, take over, pause, pace, and what is to become of the episode."""

from collections.abc import Callable
from html import escape

import viser

from sheath_manip.cockpit import Cockpit, Order
from sheath_manip.cockpit.cockpit import State
from sheath_manip.cockpit.orders import FASTEST, SLOWEST
from sheath_manip.cockpit.shown import Shown
from sheath_manip.dashboard.changed import set_changed
from sheath_manip.dashboard.markup import GREY_BUTTON
from sheath_manip.dashboard.operator_socket import station_of
from sheath_manip.dashboard.snapshot import Snapshot
from sheath_manip.dashboard.widget import WidgetContext

_EPISODE = {
    "Success": Order.SUCCESS,
    "Failure": Order.FAILURE,
    "Save": Order.SAVE,
    "Discard": Order.DISCARD,
}
"""in words that its hotkeys (G F V Z) go with"""
_RED = (190, 30, 45)
"""on which white letters have a contrast of 6 to 1; on viser's own it is 3.3"""


class Controls:
    """Every element only gives an order, and returns.

    A click means what its button said when it was last drawn: what has changed since, its giver has
    not seen. The stop is a button of its own, so that a page which lags behind cannot reset one.
    """

    def __init__(self, context: WidgetContext, cockpit: Cockpit) -> None:
        self._context = context
        self._cockpit = cockpit
        self._drawn = cockpit.state
        gui, operated = context.viser.gui, bool(cockpit.guide)
        self.stop = gui.add_button("STOP (Space)", color=_RED, visible=operated)
        self.reset = gui.add_button("Reset the stop (R)", color=GREY_BUTTON, visible=False)
        self.take = gui.add_button("Take over (T)", color="orange", visible=operated)
        self.keep = gui.add_button("Keep the episode (C)", color="orange", visible=False)
        self.go_on = gui.add_button("Let the policy go on (H)", color=GREY_BUTTON, visible=False)
        self.pause = gui.add_button("Pause (P)", color=GREY_BUTTON, icon=viser.Icon.PLAYER_PAUSE)
        self.step = gui.add_button(
            "One step (.)", color=GREY_BUTTON, icon=viser.Icon.PLAYER_TRACK_NEXT, visible=False
        )
        self.speed = gui.add_slider(
            "Speed", min=SLOWEST, max=FASTEST, step=0.1, initial_value=1.0, visible=cockpit.paced
        )
        self.episode = gui.add_button_group("Episode", tuple(_EPISODE), visible=operated)
        guide = gui.add_html(_guide(cockpit), visible=operated)
        orders = (self.stop, self.reset, self.take, self.keep, self.go_on, self.pause, self.step)
        self._all = (*orders, self.speed, self.episode, guide)
        self._bind(self.stop, lambda _: Order.STOP)
        self._bind(self.reset, lambda _: Order.RESET)
        self._bind(self.take, lambda drawn: Order.HAND_BACK if drawn.taken else Order.TAKE_OVER)
        self._bind(self.keep, lambda _: Order.CALL_OFF)
        self._bind(self.go_on, lambda _: Order.HAND_BACK)
        self._bind(self.pause, lambda _: Order.RESUME if cockpit.paused else Order.PAUSE)
        self._bind(self.step, lambda _: Order.STEP)

        @self.speed.on_update
        async def _(event: viser.GuiEvent) -> None:
            # An update without a client is the program's own.
            if event.client_id is not None:
                self._give(Order.SPEED, event, float(self.speed.value))

        @self.episode.on_click
        async def _(event: viser.GuiEvent) -> None:
            self._give(_EPISODE[self.episode.value], event)

    def draw(self, snapshot: Snapshot) -> None:  # noqa: ARG002
        """Have each button offer the other of its two."""
        self._drawn = state = self._cockpit.state
        if state.over:
            for each in self._all:
                set_changed(each, visible=False)
            return
        set_changed(self.reset, visible=state.stopped)
        set_changed(self.take, label=_take(state), color="green" if state.taken else "orange")
        set_changed(self.keep, visible=state.discard_s is not None)
        set_changed(self.go_on, visible=state.abandoned)
        set_changed(
            self.pause,
            label="Resume (P)" if state.paused else "Pause (P)",
            icon=viser.Icon.PLAYER_PLAY if state.paused else viser.Icon.PLAYER_PAUSE,
            color="green" if state.paused else GREY_BUTTON,
        )
        set_changed(self.step, visible=state.paused)

    def _bind(self, button: viser.GuiButtonHandle, meant: Callable[[State], Order]) -> None:
        @button.on_click
        async def _(event: viser.GuiEvent) -> None:
            self._give(meant(self._drawn), event)

    def _give(self, order: Order, event: viser.GuiEvent, value: float = 1.0) -> None:
        if event.client_id is not None:
            station = station_of(event.client_id)
            drawn = self._drawn
            shown = Shown(drawn.stops, drawn.robot, drawn.episode)
            self._cockpit.order(order, station, value, shown)
        self._context.wake()


def _take(state: State) -> str:
    if state.taken:
        return "Hand back (H)"
    return "The robot asks: take over (T)" if state.asking else "Take over (T)"


def _guide(cockpit: Cockpit) -> str:
    rows = "".join(
        f'<tr><td style="white-space:nowrap;padding-right:1em"><b>{escape(each.shown)}</b></td>'
        f"<td>{escape(each.says)}</td></tr>"
        for each in cockpit.guide
    )
    return (
        '<div style="margin:.4em 1.1em;font-size:.85em"><details><summary>Keys while you drive'
        f"</summary><table>{rows}</table></details></div>"
    )
