"""What a page is made of: widgets, each a file of its own, and the layout that names them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Protocol

import viser

from sheath_manip.dashboard.snapshot import Snapshot
from sheath_manip.types import TaskSpec


@dataclass(frozen=True, eq=False)
class WidgetContext:
    """The context that a widget is built in.

    A widget's callbacks run on viser's thread: they only take note of what a person asks for, clamp
    it, and call `wake`. The one that can do it (control loop, worker, drawer) looks there.
    """

    viser: viser.ViserServer
    spec: TaskSpec
    wake: Callable[[], None]
    """ask for a drawing soon; returns at once"""
    allows: Callable[[int | None], bool] = lambda _: True
    """whether the browser of that client id may change what the run does"""


class Widget(Protocol):
    """One piece of a page: makes its elements when it is built, and draws snapshots into them.

    Every name that comes from data is escaped.
    """

    def draw(self, snapshot: Snapshot) -> None:
        """Show `snapshot`; called on the drawer's thread, up to 20 times a second."""
        ...


WidgetFactory = Callable[[WidgetContext], Widget]
"""a widget's class, or a `partial` of it with what it needs beside the context"""


@dataclass(frozen=True)
class Layout:
    """The widgets that a page has, and where."""

    world: tuple[WidgetFactory, ...] = ()
    """in the 3-D scene, or in windows of their own"""
    head: tuple[WidgetFactory, ...] = ()
    """above the tabs, always in view"""
    tabs: Mapping[str, tuple[WidgetFactory, ...]] = field(default_factory=dict)
    """by the tab's title, in their order"""
