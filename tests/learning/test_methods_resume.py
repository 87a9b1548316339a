"""Methods that were stopped at any file resume to the same result."""

import json
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from sheath_manip.learning.checkpoint import Checkpoint, digest
from tests.learning.buttons_run import run, uninterrupted
from tests.writing import WriterHere


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> Path:
    return uninterrupted(tmp_path_factory)


def contents(directory: Path, name: str) -> dict[str, str]:
    """Digests of the checkpoints and the results but for the time they took."""
    found = {path.name: digest(path) for path in (directory / "s0" / name).glob("*.npz")}
    for path in (directory / "s0" / name).glob("*.json"):
        found[path.name] = repr(json.loads(path.read_text()) | {"wall_s": None})
    return found


class StoppedError(KeyboardInterrupt):
    """Stands for the power cut."""


@pytest.fixture
def _cut(monkeypatch) -> Iterator[None]:
    """Stops before every file, once."""
    seen: set[str] = set()
    for owner, name in ((WriterHere, "append_arrays"), (Checkpoint, "save")):
        write = getattr(owner, name)

        def written(*arguments, write=write):
            header = getattr(arguments[1], "header", None)
            file = str(arguments[1] if header is None else header.info)
            if file not in seen:
                seen.add(file)
                raise StoppedError(file)
            return write(*arguments)

        monkeypatch.setattr(owner, name, written)
    yield
    assert seen


@pytest.mark.usefixtures("_cut")
@pytest.mark.parametrize("name", ["smile", "thrifty-dagger", "shiv", "hg-dagger"])
def test_stopped_at_any_file_it_resumes_to_the_same_result(name, whole, tmp_path):
    shutil.copytree(whole / "s0" / "expert", tmp_path / "s0" / "expert")
    shutil.copytree(whole / "store", tmp_path / "store")
    for path in (tmp_path / "store").glob("learning-*"):
        path.unlink()
    for _ in range(100):
        try:
            run(name, tmp_path)
        except StoppedError:
            continue
        break
    assert contents(tmp_path, name) == contents(whole, name)
