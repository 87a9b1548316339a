"""A run is resumed with the settings that it was begun with."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from sheath_manip.exceptions import ParameterError
from sheath_manip.json_files import plain, write_json


def require_same_plan(settings: Mapping[str, Any], path: Path) -> None:
    """Write the `settings` to `path` or compare with those there; ParameterError for others."""
    described = plain(settings)
    if not path.exists():
        write_json(path, described)
        return
    held = json.loads(path.read_text())
    if held != described:
        keys = sorted(key for key in {*held, *described} if held.get(key) != described.get(key))
        raise ParameterError(
            f"{path.parent} holds a run with another {', '.join(keys)}; "
            "resume with the same settings, name another directory, or start it afresh"
        )
