"""The button that holds the run."""

import viser

from sheath_manip.dashboard.hold import Hold
from sheath_manip.dashboard.moment import Moment
from sheath_manip.dashboard.part import Desk


class PauseButton:
    """Offers the other of pausing and resuming."""

    def __init__(self, desk: Desk, hold: Hold) -> None:
        self._button = desk.viser.gui.add_button(
            "Pause", icon=viser.Icon.PLAYER_PAUSE, color="gray"
        )

        @self._button.on_click
        async def _(_: viser.GuiEvent[viser.GuiButtonHandle]) -> None:
            if hold.paused:
                hold.resume()
            else:
                hold.pause()
            self._show(hold.paused)
            desk.wake()

    def draw(self, moment: Moment) -> None:
        """Follow what others did to the switch."""
        self._show(moment.paused)

    def _show(self, paused: bool) -> None:
        self._button.label = "Resume" if paused else "Pause"
        self._button.icon = viser.Icon.PLAYER_PLAY if paused else viser.Icon.PLAYER_PAUSE
        self._button.color = "green" if paused else "gray"
