"""Scrubber, play, pace: where in a recorded episode the page is."""

import viser

from sheath_manip.dashboard.markup import note
from sheath_manip.dashboard.player import FASTEST, SLOWEST, Player
from sheath_manip.dashboard.snapshot import Snapshot
from sheath_manip.dashboard.widget import WidgetContext

STEPS = {"« 10": -10, "‹ 1": -1, "1 ›": 1, "10 »": 10}


class Transport:
    """Every element only asks the player."""

    def __init__(self, context: WidgetContext, player: Player) -> None:
        gui = context.viser.gui
        self._player = player
        self.play = gui.add_button("Pause", icon=viser.Icon.PLAYER_PAUSE, color="gray")
        self.scrubber = gui.add_slider("Step", min=0, max=1, step=1, initial_value=0)
        self.steps = gui.add_button_group("Go", tuple(STEPS))
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
                player.look_at(int(self.scrubber.value))

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
        self.play.label = "Pause" if now.playing else "Play"
        self.play.icon = viser.Icon.PLAYER_PAUSE if now.playing else viser.Icon.PLAYER_PLAY
        self.play.color = "gray" if now.playing else "green"
        last = max(len(snapshot.trace) - 1, 1)
        if self.scrubber.max != last:
            self.scrubber.max = last
        if self.scrubber.value != snapshot.at:
            self.scrubber.value = max(snapshot.at, 0)
        self._note.content = note(now.note)
        self._note.visible = bool(now.note)
