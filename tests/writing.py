"""Episodes written where the tests run: starting a process takes longer than most of their runs.

The process itself is tested in `tests/dataset/`, and with all the rest in
`tests/cli/test_cli_process.py`.
"""

from collections.abc import Iterator
from pathlib import Path

import pytest

from sheath_manip.dataset import background
from sheath_manip.dataset.recorded import Recorded
from sheath_manip.dataset.store import EpisodeStore


class WriterHere:
    """As `WriterProcess`."""

    def __init__(self, path: Path) -> None:
        self._store = EpisodeStore(path)

    def append_arrays(self, recorded: Recorded) -> None:
        self._store.keep(recorded)

    def close(self) -> None:
        pass


@pytest.fixture(scope="module", autouse=True)
def writes_here() -> Iterator[None]:
    """For the tests of a folder whose conftest imports this."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(background, "WriterProcess", WriterHere)
        yield
