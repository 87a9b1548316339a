"""The box that makes the view go along with the tool."""

import viser

from sheath_manip.dashboard.changed import set_changed
from sheath_manip.dashboard.following import Following
from sheath_manip.dashboard.snapshot import Snapshot
from sheath_manip.dashboard.widget import WidgetContext


class FollowBox:
    """Sets the switch, for all who look."""

    def __init__(self, context: WidgetContext, following: Following) -> None:
        self._box = context.viser.gui.add_checkbox("Follow the robot", following.on)

        @self._box.on_update
        async def _(_: viser.GuiEvent[viser.GuiCheckboxHandle]) -> None:
            following.on = bool(self._box.value)
            context.wake()

    def draw(self, snapshot: Snapshot) -> None:
        """Show whether there is a tool to follow, which only a person switches.

        A task without a tool has none.
        """
        set_changed(self._box, visible=snapshot.pose.tool_m is not None)
