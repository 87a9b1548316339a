"""What a learning run or an experiment left on disk, to compare it with another."""

import json
from pathlib import Path

from sheath_manip.learning.checkpoint import digest


def digests(directory: Path) -> dict[str, str]:
    """Of all checkpoints."""
    return {str(p.relative_to(directory)): digest(p) for p in sorted(directory.rglob("*.npz"))}


def measured(directory: Path) -> dict[str, dict]:
    """All results, but for the time they took."""
    found = {}
    for path in sorted(directory.rglob("round-*.json")):
        found[str(path.relative_to(directory))] = json.loads(path.read_text()) | {"wall_s": None}
    return found
