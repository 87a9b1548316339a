"""The scripts that each page gets: the parts in a folder, in one function of their own."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

_CHART_HOVER = Path(__file__).with_name("chart_hover.js")
_STATION = Path(__file__).with_name("station")
_PARTS = ("keyboard", "gamepad", "notice", "attention", "deck", "naming", "robots", "station")
"""the last one uses the others"""


def page_script(settings: Mapping[str, Any]) -> str:
    """JavaScript that runs in the page; `settings` are what its parts find under that name."""
    style = (_STATION / "station.css").read_text()
    return bundled(_STATION, _PARTS, dict(settings) | {"style": style})


def chart_script() -> str:
    """JavaScript by which the charts of the page show the numbers of each round."""
    return f"({_CHART_HOVER.read_text()})()"


def bundled(folder: Path, parts: Sequence[str], settings: Mapping[str, Any]) -> str:
    """Return the `parts` of a `folder` as one piece of JavaScript; the last one uses the others."""
    sources = "\n".join((folder / f"{name}.js").read_text() for name in parts)
    return f'(function (settings) {{\n"use strict";\n{sources}\n}})({json.dumps(settings)})'
