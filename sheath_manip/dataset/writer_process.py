"""A process that writes episodes, since hundreds of system calls would hold up a simulation.

In a thread each of them gives the interpreter's lock away and waits to have it back, and so does
the simulation. The process imports only the standard library: it is there after some 30 ms.
"""

import pickle
import subprocess
import sys
from contextlib import suppress
from pathlib import Path
from typing import IO

from sheath_manip.dataset.durable import Files, publish_files

_ROOT = Path(__file__).parents[2]
_CODE = f"""
import sys
sys.path.append({str(_ROOT)!r})
from sheath_manip.dataset.writer_process import serve
serve(sys.stdin.buffer, sys.stdout.buffer)
"""


class WriterProcess:
    """Its `publish` is `publish_files` in another process; to be closed. Raises OSError.

    What it has been handed whole it writes to the end, also where this process is killed meanwhile.
    """

    def __init__(self) -> None:
        self._process = subprocess.Popen(
            # Neither the environment nor site-packages: nothing there is needed.
            [sys.executable, "-I", "-S", "-c", _CODE],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            # Ctrl-C is for this process, which lets the writer finish.
            start_new_session=True,
        )

    @property
    def process_id(self) -> int:
        """Of the operating system's."""
        return self._process.pid

    def publish(self, files: Files, aside: Path, final: Path) -> None:
        """As `publish_files`; raises OSError also where the process is gone."""
        requests, answers = self._process.stdin, self._process.stdout
        assert requests is not None
        assert answers is not None
        try:
            # It was started in the directory of that time.
            _send((files, aside.absolute(), final.absolute()), requests)
            error = pickle.load(answers)
        except (BrokenPipeError, EOFError, pickle.UnpicklingError) as broken:
            raise OSError(
                f"the process that writes ended with code {self._process.wait()}; run it again"
            ) from broken
        if error is not None:
            raise error

    def close(self) -> None:
        """End the process."""
        # What a broken pipe did not take was told of by `publish`.
        with suppress(BrokenPipeError), self._process:
            pass


def serve(requests: IO[bytes], answers: IO[bytes]) -> None:
    """Publish what comes until no more does, and answer each with None or an OSError."""
    # Whoever asked may be killed at any moment: half a request is none, and nobody hears an answer.
    with suppress(EOFError, pickle.UnpicklingError, BrokenPipeError):
        while True:
            request = pickle.load(requests)
            error = None
            try:
                publish_files(*request)
            except OSError as raised:
                error = raised
            _send(error, answers)


def _send(message: object, to: IO[bytes]) -> None:
    pickle.dump(message, to, pickle.HIGHEST_PROTOCOL)
    to.flush()
