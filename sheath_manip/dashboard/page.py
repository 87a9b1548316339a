"""The page: the parts of a layout, in their places."""

from typing import TypeVar

from sheath_manip.dashboard.moment import Moment
from sheath_manip.dashboard.part import Desk, Layout, Part
from sheath_manip.dashboard.parts.trouble import Trouble

AnyPart = TypeVar("AnyPart", bound=Part)


class Page:
    """Builds the parts and has each draw every moment."""

    def __init__(self, desk: Desk, layout: Layout) -> None:
        self._viser = desk.viser
        self._parts = [make(desk) for make in layout.world]
        self._parts += [make(desk) for make in layout.head]
        tabs = desk.viser.gui.add_tab_group()
        for title, makers in layout.tabs.items():
            with tabs.add_tab(title):
                self._parts += [make(desk) for make in makers]

    @property
    def watched(self) -> bool:
        """Whether any browser shows the page."""
        return bool(self._viser.get_clients())

    def part(self, kind: type[AnyPart]) -> AnyPart:
        """The part of that kind; raises LookupError where the layout has none."""
        for part in self._parts:
            if isinstance(part, kind):
                return part
        raise LookupError(f"this page has no {kind.__name__}")

    def draw(self, moment: Moment) -> None:
        """Show `moment`, in about the time that its images take to encode."""
        with self._viser.atomic():
            for part in self._parts:
                part.draw(moment)

    def show_trouble(self, failure: str) -> None:
        """Say that what is shown is out of date, until the next drawing."""
        for part in self._parts:
            if isinstance(part, Trouble):
                part.show(failure)
