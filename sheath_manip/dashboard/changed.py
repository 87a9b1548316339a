"""Setting of viser's elements only what differs from before."""

from typing import Any


def set_changed(element: Any, **properties: Any) -> None:
    """Set those `properties` of an element of the page that have another value now.

    viser leaves out what is the same, too, but looks up and casts each value first: most that a
    drawing sets is as before, and this was a quarter of its time. Not for arrays.
    """
    for name, value in properties.items():
        if getattr(element, name) != value:
            setattr(element, name, value)
