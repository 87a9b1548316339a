"""The episode as a video or a page of its own, given to the browser that asks for it."""

from collections.abc import Callable

import viser

from sheath_manip.dashboard.markup import caption
from sheath_manip.dashboard.player import Player
from sheath_manip.dashboard.snapshot import Snapshot
from sheath_manip.dashboard.widget import WidgetContext

KINDS = ("mp4", "html")

Exporting = Callable[[int, str], tuple[str, bytes]]
"""from the place of an episode and one of KINDS: the name of the file, and its content"""


class Export:
    """A button by which the browser downloads the episode; nothing is written on this machine."""

    def __init__(self, context: WidgetContext, player: Player, exporting: Exporting) -> None:
        gui = context.viser.gui
        gui.add_html(caption("Take it along", "as a video, or as one page without network"))
        self.kinds = gui.add_button_group("Download", KINDS)

        @self.kinds.on_click
        async def _(event: viser.GuiEvent) -> None:
            client, kind, place = event.client, self.kinds.value, player.now.place
            if client is None:
                return

            def work() -> None:
                name, content = exporting(place, kind)
                client.send_file_download(name, content, save_immediately=True)
                player.say(f"{name}: {len(content) / 1e6:.1f} MB")

            player.do(work, f"making the {kind}; this takes some seconds …")

    def draw(self, snapshot: Snapshot) -> None:
        """Do nothing: the button stays as it is."""
