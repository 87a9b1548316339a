"""Says on the page that what it shows is out of date."""

from html import escape

from sheath_manip.dashboard.changed import set_changed
from sheath_manip.dashboard.markup import BOX
from sheath_manip.dashboard.snapshot import Snapshot
from sheath_manip.dashboard.widget import WidgetContext
from sheath_manip.playback import palette
from sheath_manip.types import Outcome


class Trouble:
    """A red box while drawing fails, else nothing."""

    def __init__(self, context: WidgetContext) -> None:
        self._box = context.viser.gui.add_html("", visible=False)

    def draw(self, snapshot: Snapshot) -> None:
        """Hide the notice: what can be drawn is not out of date."""
        del snapshot
        set_changed(self._box, visible=False)

    def show(self, failure: str) -> None:
        """Say what failed."""
        # The text first: an empty box would be seen for a moment otherwise.
        self._box.content = (
            f'<div style="{BOX};background:{palette.css(palette.OUTCOME[Outcome.FAILURE])}">'
            f"<b>This page is out of date.</b><br>{escape(failure)}</div>"
        )
        self._box.visible = True
