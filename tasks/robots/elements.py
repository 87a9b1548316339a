"""Finds elements of MJCF, and what they have from their default classes."""

from typing import Any

from sheath_manip.exceptions import ParameterError


def inherited(element: Any, attribute: str, otherwise: Any) -> Any:
    """Return what MuJoCo's compiler will take for an attribute; `otherwise` where nobody says."""
    own = getattr(element, attribute)
    if own is not None:
        return own
    default = element.dclass if hasattr(element, "dclass") else None
    if isinstance(default, str):
        default = element.root.find("default", default)
    default = default or _class_of_bodies(element) or element.root.default
    while default is not None and default.tag == "default":
        said = getattr(getattr(default, element.tag, None), attribute, None)
        if said is not None:
            return said
        default = default.parent
    return otherwise


def _class_of_bodies(element: Any) -> Any:
    """The class that the nearest body around it gives to its children."""
    body = element.parent
    while body is not None and body.tag in ("body", "worldbody"):
        child_class = getattr(body, "childclass", None)
        if child_class is not None:
            if isinstance(child_class, str):
                return element.root.find("default", child_class)
            return child_class
        body = body.parent
    return None


def found(root: Any, kind: str, name: str) -> Any:
    """Return the element of that name; raises ParameterError that says what there is."""
    element = root.find(kind, name)
    if element is None:
        there = ", ".join(each.name for each in root.find_all(kind) if each.name) or "none"
        raise ParameterError(f"{root.model} has no {kind} {name!r}; it has {there}")
    return element
