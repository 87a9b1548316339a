"""A run is resumed with the settings that it was begun with."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from sheath_manip.exceptions import ParameterError
from sheath_manip.files.json_files import plain, write_json
from sheath_manip.learning.config import LearningPlan
from sheath_manip.learning.flat_plans import upgraded
from sheath_manip.rollout.device import is_cpu, torch_device


def require_same_plan(settings: Mapping[str, Any], path: Path) -> None:
    """Write the `settings` to `path` or compare with those there; ParameterError for others.

    Another device than the CPU is one of them, since its low bits are its own.
    """
    described = plain(settings if is_cpu() else {**settings, "device": torch_device().type})
    if not path.exists():
        write_json(path, described)
        return
    held, described = (
        _leaves(each) for each in (upgraded(json.loads(path.read_text())), described)
    )
    # A run that was begun before there was a setting had what is its default now.
    defaults = _leaves(plain(LearningPlan().described()))
    held = {name: defaults[name] for name in described.keys() & defaults.keys()} | held
    if held != described:
        names = sorted(
            name for name in {*held, *described} if held.get(name) != described.get(name)
        )
        raise ParameterError(
            f"{path.parent} holds a run with another {', '.join(names)}; "
            "resume with the same settings, name another directory, or start it afresh with --fresh"
        )


def without_seeds(plan: LearningPlan) -> dict[str, Any]:
    """Return the settings of `plan` that runs of several seeds in one directory have in common."""
    settings = plan.described()
    return {**settings, "comparison": {**settings["comparison"], "seeds": None}}


def _leaves(content: Mapping[str, Any], above: str = "") -> dict[str, Any]:
    """The values by their dotted names."""
    leaves: dict[str, Any] = {}
    for name, value in content.items():
        inner = _leaves(value, f"{above}{name}.") if isinstance(value, Mapping) else {}
        leaves |= inner or {f"{above}{name}": value}
    return leaves
