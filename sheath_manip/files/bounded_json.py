"""JSON that anybody may have written, read within bounds of depth and size."""

import json
import re
from typing import Any

MOST_DEPTH = 16
"""of objects and lists in each other; what is written here has five"""
# A text whole, so that a bracket in it does not count.
_BRACKET = re.compile(rb'"(?:[^"\\]|\\.)*"|([\[{])|([\]}])', re.DOTALL)


def parse_json(content: bytes) -> Any:
    """Return what the JSON text `content` says.

    Raises ValueError where it is none, is nested too deep, names a field twice or holds NaN.
    """
    depth = 0
    for found in _BRACKET.finditer(content):
        depth += (found[1] is not None) - (found[2] is not None)
        if depth > MOST_DEPTH:
            raise ValueError(f"it is nested more than {MOST_DEPTH} deep")
    try:
        return json.loads(
            content.decode(), object_pairs_hook=_once, parse_constant=_refuse_constant
        )
    except RecursionError as error:
        raise ValueError("it is nested too deep") from error


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    fields = dict(pairs)
    if len(fields) < len(pairs):
        raise ValueError("it names a field twice")
    return fields


def _refuse_constant(name: str) -> Any:
    raise ValueError(f"{name} is no number")
