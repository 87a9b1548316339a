"""Scrubber, play, pace: where in a recorded episode the page is."""

import viser

from sheath_manip.dashboard.changed import set_changed
from sheath_manip.dashboard.markup import GREY_BUTTON, note
from sheath_manip.dashboard.player import FASTEST, SLOWEST, Player
from sheath_manip.dashboard.snapshot import Snapshot
from sheath_manip.dashboard.widget import WidgetContext

STEPS = {"« 10": -10, "‹ 1": -1, "1 ›": 1, "10 »": 10}


class Transport:
    """Every element only asks the player; a person counts steps from 1."""

    def __init__(self, context: WidgetContext, player: Player) -> None:
        gui = context.viser.gui
        self._player = player
        self._overtaken = False
        """whether a browser may have got an older step after the one that it asked for"""
        self._known = 1
        """what the slider was last put to here, or heard to be put to by a browser"""
        self.play = gui.add_button("Pause", icon=viser.Icon.PLAYER_PAUSE, color=GREY_BUTTON)
        self.scrubber = gui.add_slider("Step", min=1, max=2, step=1, initial_value=1)
        self.steps = gui.add_button_group("Jump", tuple(STEPS))
        self.speed = gui.add_slider(
            "Speed",
            min=min(SLOWEST, player.now.speed),
            max=max(FASTEST, player.now.speed),
            step=0.1,
            initial_value=player.now.speed,
        )
        self._note = gui.add_html("", visible=False)

        @self.play.on_click
        async def _(_: viser.GuiEvent) -> None:
            player.toggle()

        # What a widget sets itself comes without a client.
        @self.scrubber.on_update
        async def _(event: viser.GuiEvent) -> None:
            if event.client_id is not None:
                self._known = int(self.scrubber.value)
                self._overtaken |= player.now.playing
                player.look_at(self._known - 1)

        @self.steps.on_click
        async def _(_: viser.GuiEvent) -> None:
            player.nudge(STEPS[self.steps.value])

        @self.speed.on_update
        async def _(event: viser.GuiEvent) -> None:
            if event.client_id is not None:
                player.pace(float(self.speed.value))

    def draw(self, snapshot: Snapshot) -> None:
        """Put the scrubber where the player is."""
        now = self._player.now
        set_changed(
            self.play,
            label="Pause" if now.playing else "Play",
            icon=viser.Icon.PLAYER_PAUSE if now.playing else viser.Icon.PLAYER_PLAY,
            color=GREY_BUTTON if now.playing else "green",
        )
        last, at = max(len(snapshot.trace), 2), max(snapshot.at + 1, 1)
        if self.scrubber.max != last:
            self.scrubber.max = last
        if self._overtaken and not now.playing:
            self._overtaken = False
            # viser sends no value that it has already, so it is given another one before.
            self._put(at + 1 if at < last else at - 1)
        # Another value than the known one came from a browser, and is heard in a moment.
        if self.scrubber.value == self._known != at:
            self._put(at)
        set_changed(self._note, content=note(now.note), visible=bool(now.note))

    def _put(self, step: int) -> None:
        self._known = step
        self.scrubber.value = step
