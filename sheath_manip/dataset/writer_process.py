"""A process that writes episodes into a store, so that a simulation need not wait for it.

In a thread each of some hundred system calls and compressions gives the interpreter's lock away and
waits to have it back, and so does the simulation.
"""

import pickle
import subprocess
import sys
from contextlib import suppress
from pathlib import Path
from typing import IO

from sheath_manip.dataset.recorded import Recorded
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import SheathError, StoreError

# What it imports is what this process imports, in a checkout as from a wheel.
_CODE = """
import sys
sys.path[:] = sys.argv[2:]
from sheath_manip.dataset.writer_process import serve
serve(sys.argv[1], sys.stdin.buffer, sys.stdout.buffer)
"""


class WriterProcess:
    """A process that appends episodes to the store at `path`; to be closed.

    What it has been handed whole it writes to the end, also where this process is killed meanwhile.
    Raises StoreError where it cannot be started.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        try:
            self._process = subprocess.Popen(
                # The path may be relative, and this process may go elsewhere.
                [sys.executable, "-P", "-c", _CODE, str(path.absolute()), *_search_path()],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                # Ctrl-C is for this process, which lets the writer finish.
                start_new_session=True,
            )
        except OSError as error:
            raise StoreError(
                f"cannot start the process that writes into {path} ({error})"
            ) from error

    @property
    def process_id(self) -> int:
        """The process id that the operating system gave."""
        return self._process.pid

    def append_arrays(self, recorded: Recorded) -> None:
        """Store an episode as `EpisodeStore.append_arrays` does.

        Raises StoreError also where the process is gone.
        """
        requests, answers = self._process.stdin, self._process.stdout
        assert requests is not None
        assert answers is not None
        try:
            _send(recorded, requests)
            told = pickle.load(answers)
        except (BrokenPipeError, EOFError, pickle.UnpicklingError) as broken:
            raise StoreError(
                f"the process that writes into {self.path} ended with code "
                f"{self._process.wait()}; the last episode may not be stored: run it again"
            ) from broken
        if told is not None:
            raise StoreError(told)

    def close(self) -> None:
        """End the process, which has nothing to do when `append_arrays` has returned."""
        self._process.kill()
        # What a broken pipe did not take was told of by `append_arrays`.
        with suppress(BrokenPipeError), self._process:
            pass


def serve(path: str, requests: IO[bytes], answers: IO[bytes]) -> None:
    """Adopt what comes until no more does, and answer each with None or with what went wrong."""
    # Its parent may be killed at any moment: half a request is none, and nobody hears an answer.
    with suppress(EOFError, pickle.UnpicklingError, BrokenPipeError):
        while True:
            recorded = pickle.load(requests)
            told = None
            try:
                EpisodeStore(path).append_arrays(recorded)
            except SheathError as error:
                told = str(error)
            _send(told, answers)


def _search_path() -> list[str]:
    # An empty entry is the working directory.
    return [entry or str(Path.cwd()) for entry in sys.path]


def _send(message: object, to: IO[bytes]) -> None:
    pickle.dump(message, to, pickle.HIGHEST_PROTOCOL)
    to.flush()
