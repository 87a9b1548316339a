"""The page: the widgets of a layout, in their places."""

from typing import TypeVar

from sheath_manip.dashboard.snapshot import Snapshot
from sheath_manip.dashboard.widget import Layout, Widget, WidgetContext
from sheath_manip.dashboard.widgets.trouble import Trouble

AnyWidget = TypeVar("AnyWidget", bound=Widget)


class Page:
    """Builds the widgets and has each draw every snapshot."""

    def __init__(self, context: WidgetContext, layout: Layout) -> None:
        self._viser = context.viser
        self._widgets = [make(context) for make in layout.world]
        self._widgets += [make(context) for make in layout.head]
        tabs = context.viser.gui.add_tab_group()
        for title, factories in layout.tabs.items():
            with tabs.add_tab(title):
                self._widgets += [make(context) for make in factories]

    @property
    def watched(self) -> bool:
        """Whether any browser shows the page."""
        return bool(self._viser.get_clients())

    def widget(self, kind: type[AnyWidget]) -> AnyWidget:
        """The widget of that kind; raises LookupError where the layout has none."""
        for widget in self._widgets:
            if isinstance(widget, kind):
                return widget
        raise LookupError(f"this page has no {kind.__name__}")

    def draw(self, snapshot: Snapshot) -> None:
        """Show `snapshot`, in about the time that its images take to encode."""
        with self._viser.atomic():
            for widget in self._widgets:
                widget.draw(snapshot)

    def show_trouble(self, failure: str) -> None:
        """Say that what is shown is out of date, until the next drawing."""
        for widget in self._widgets:
            if isinstance(widget, Trouble):
                widget.show(failure)
