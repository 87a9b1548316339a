"""What may have been meant by a path where nothing is."""

from difflib import get_close_matches
from pathlib import Path


def nearest_beside(path: Path) -> str:
    """Return `; did you mean ...?` with the name in that directory that is nearest, or nothing."""
    try:
        names = [entry.name for entry in path.parent.iterdir() if entry.name != path.name]
    except OSError:
        return ""
    near = get_close_matches(path.name, names, n=1)
    return f"; did you mean {path.parent / near[0]}?" if near else ""
