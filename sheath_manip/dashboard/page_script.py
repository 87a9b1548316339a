"""The script that each page gets: the parts in `station/`, in one function of their own."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

_FOLDER = Path(__file__).with_name("station")
_PARTS = ("keyboard", "gamepad", "notice", "attention", "deck", "naming", "robots", "station")
"""the last one uses the others"""


def page_script(settings: Mapping[str, Any]) -> str:
    """JavaScript that runs in the page; `settings` are what its parts find under that name."""
    given = dict(settings) | {"style": (_FOLDER / "station.css").read_text()}
    parts = "\n".join((_FOLDER / f"{name}.js").read_text() for name in _PARTS)
    return f'(function (settings) {{\n"use strict";\n{parts}\n}})({json.dumps(given)})'
