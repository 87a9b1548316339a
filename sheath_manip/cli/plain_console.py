"""A terminal on which only this program's own styles act, whatever the text says that it prints."""

from collections.abc import Iterator

from rich.console import Console, ConsoleOptions, RenderableType
from rich.segment import Segment

from sheath_manip.printable import printable


class PlainConsole(Console):
    """A console that writes out escape sequences in names of files, episodes and tasks."""

    def render(
        self, renderable: RenderableType, options: ConsoleOptions | None = None
    ) -> Iterator[Segment]:
        """Yield what is printed, in printable letters; rich's own control codes stay."""
        for segment in super().render(renderable, options):
            yield segment if segment.control else segment._replace(text=printable(segment.text))
