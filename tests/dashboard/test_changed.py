"""Of the page's elements only what differs is set."""

from typing import Any

from sheath_manip.dashboard.changed import set_changed


class Element:
    """Notes what is set of it, as viser's elements send it."""

    sent: list[tuple[str, Any]]

    def __init__(self) -> None:
        self.__dict__.update(content="a", visible=False, sent=[])

    def __setattr__(self, name: str, value: Any) -> None:
        self.__dict__[name] = value
        self.sent.append((name, value))


def test_what_is_as_before_is_not_set():
    element = Element()
    set_changed(element, content="a", visible=False)
    assert element.sent == []


def test_what_differs_is_set_in_the_order_given():
    element = Element()
    set_changed(element, content="b", visible=True)
    set_changed(element, content="b", visible=False)
    assert element.sent == [("content", "b"), ("visible", True), ("visible", False)]
