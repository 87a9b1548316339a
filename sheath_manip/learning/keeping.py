"""A fit that took its time is not lost to a full disk."""

import shlex
import tempfile
import uuid
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

from sheath_manip.exceptions import CheckpointError
from sheath_manip.learning.checkpoint import Checkpoint
from sheath_manip.learning.gate_file import ExternalGate


def keep(checkpoint: Checkpoint | ExternalGate, path: Path) -> None:
    """Save a checkpoint at `path` or, where it cannot be written there, in another folder.

    Raises CheckpointError in the second case too: it says where the file is, and how to put it
    where it was wanted.
    """
    try:
        checkpoint.save(path)
    except OSError as error:
        refused = f"cannot write {path} ({error.strerror or error})"
        tried = []
        for folder in _folders():
            kept = folder / f"sheath-kept-{uuid.uuid4().hex[:8]}" / path.name
            tried.append(str(folder))
            with suppress(OSError):
                checkpoint.save(kept)
                raise CheckpointError(
                    f"{refused}; the fit is kept: make room, then "
                    f"`mv {shlex.quote(str(kept))} {shlex.quote(str(path))}`"
                ) from error
            with suppress(OSError):
                kept.parent.rmdir()
        raise CheckpointError(
            f"{refused}, nor could the fit be kept in {', '.join(tried)}; make room and fit again"
        ) from error


def _folders() -> Iterator[Path]:
    """The folders that may have room where the wanted one has none."""
    with suppress(OSError):
        yield Path(tempfile.gettempdir())
    with suppress(OSError):
        yield Path.cwd()
    with suppress(RuntimeError):
        yield Path.home()
