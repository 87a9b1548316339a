"""JSON files that a reader sees whole or not at all, and values as JSON knows them."""

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from sheath_manip.files.outputs import written_aside


def write_json(path: Path, content: Any) -> None:
    """Write `content` in one stroke: a reader of `path` sees the old file or the new one."""
    with written_aside(path) as aside, aside.open("w") as file:
        json.dump(content, file, indent=1)


def plain(value: Any) -> Any:
    """Return a value as it will be when read back from JSON, which knows neither tuples nor NaN."""
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if isinstance(value, float | np.floating):
        return float(value) if math.isfinite(value) else None
    return value


def strict_float(value: float) -> float | str:
    """Strict JSON has no NaN and no infinity: they are named, and `float` reads the names."""
    if math.isfinite(value):
        return value
    return "NaN" if math.isnan(value) else "Infinity" if value > 0 else "-Infinity"
