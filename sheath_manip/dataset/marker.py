"""The small file that says that a directory is an episode store, and of which schema."""

import json
import re
from datetime import UTC, datetime
from pathlib import Path

from sheath_manip.dataset.fields import shown
from sheath_manip.dataset.naming import LEFTOVER_PREFIX
from sheath_manip.dataset.rooted_files import read_inside
from sheath_manip.exceptions import StoreError
from sheath_manip.files.bounded_json import parse_json
from sheath_manip.files.nearest import nearest_beside
from sheath_manip.files.outputs import sync, written_aside

MARKER = "sheath-store.json"
FORMAT = "sheath-store"
SCHEMA = 2
"""of the directory; each episode has its own, see `attributes.SCHEMA`"""
READABLE = (1, SCHEMA)
"""In one of schema 1 every episode is a folder; versions that wrote that see no archive."""
MOST_MARKER_BYTES = 64 << 10
OR_A_NEW_ONE = ", or a new one to record into"
_URL = re.compile(r"[A-Za-z][A-Za-z0-9+.-]+:/")


def require_marker(path: Path) -> None:
    """Raise StoreError unless `path` is a store of this schema."""
    _require_directory(path)
    if not path.exists():
        raise _no_store(path, "nothing", nearest_beside(path))
    try:
        content = read_inside(path, MARKER, MOST_MARKER_BYTES)
    except (FileNotFoundError, NotADirectoryError) as error:
        kind = "directory" if path.is_dir() else "file"
        raise _no_store(path, f"a {kind} without {MARKER}") from error
    except OSError as error:
        raise _no_store(path, f"a {MARKER} that cannot be read ({error})") from error
    parse_marker(path, content)


def parse_marker(where: Path | str, content: bytes) -> None:
    """Raise StoreError unless `content` is the marker of a store of this schema."""
    try:
        marker = parse_json(content)
    except ValueError as error:
        raise _no_store(where, f"a {MARKER} that does not decode ({error})") from error
    if not isinstance(marker, dict) or marker.get("format") != FORMAT:
        raise _no_store(where, f"a {MARKER} of another format")
    schema = marker.get("schema")
    if type(schema) is not int or schema not in READABLE:
        raise StoreError(
            f"{where} is an episode store of schema {shown(schema)}, wanted "
            f"{' or '.join(map(str, READABLE))}; read it with the version of sheath-manip that "
            "made it"
        )


def marker_text() -> str:
    """The marker of a store that is begun now."""
    created_utc = datetime.now(UTC).isoformat(timespec="seconds")
    return json.dumps({"format": FORMAT, "schema": SCHEMA, "created_utc": created_utc})


def write_marker(path: Path) -> None:
    """Make a store of `path` unless it is one; nothing or an empty directory may be there.

    Raises StoreError where something else is, and OSError.
    """
    _require_directory(path)
    path.mkdir(parents=True, exist_ok=True)
    entries = sorted(entry.name for entry in path.iterdir())
    foreign = [name for name in entries if not name.startswith(LEFTOVER_PREFIX)]
    # Another process may have made the store since it was listed: the marker is asked for last.
    if (path / MARKER).exists():
        return
    if foreign:
        raise _no_store(path, f"a directory with {foreign[0]!r} in it", OR_A_NEW_ONE)
    with written_aside(path / MARKER) as aside:
        aside.write_text(marker_text())
    sync(path.parent)


def bring_up_marker(path: Path) -> None:
    """Say that a store holds archives, before the first one is there; raises OSError."""
    marker = parse_json(read_inside(path, MARKER, MOST_MARKER_BYTES))
    if marker["schema"] != SCHEMA:
        with written_aside(path / MARKER) as aside:
            aside.write_text(json.dumps({**marker, "schema": SCHEMA}))


def _require_directory(path: Path) -> None:
    # As a path a URL is a folder `s3:` on this machine, where nobody would look for episodes.
    if _URL.match(path.as_posix()):
        raise StoreError(
            f"{path} is a URL, wanted a directory; record into one, then push it: "
            "`sheath data merge DIRECTORY --into URL`"
        )


def _no_store(path: Path | str, found: str, otherwise: str = "") -> StoreError:
    return StoreError(
        f"wanted an episode store at {path}, found {found}; give the directory that holds "
        f"{MARKER}{otherwise}"
    )
