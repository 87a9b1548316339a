"""A process that writes episodes into a store, so that a simulation need not wait for it.

In a thread each of some hundred system calls and compressions gives the interpreter's lock away and
waits to have it back, and so does the simulation. What an episode has of images goes there a block
of frames at a time and is written as it comes: it lies there twice in no process.
"""

import fcntl
import os
import pickle
import select
import subprocess
import sys
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import IO

import numpy as np
from numpy.typing import NDArray

from sheath_manip.dataset.layout import ArraySpec, layout
from sheath_manip.dataset.recorded import Recorded
from sheath_manip.dataset.steps import require_layout
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.dataset.zarr_files import box, places
from sheath_manip.exceptions import SheathError, StoreError

PATIENCE_S = 120.0
"""Nothing that a writing process does takes that long, a slow disk's sync included; one that was
stopped is ended then."""
_WRITTEN_BYTES = 1 << 20
"""at most at a time"""
# What it imports is what this process imports, in a checkout as from a wheel.
_CODE = """
import sys
sys.path[:] = sys.argv[2:]
from sheath_manip.dataset.writer_process import serve
serve(sys.argv[1], sys.stdin.buffer, sys.stdout.buffer)
"""


class WriterLostError(StoreError):
    """The process that writes is gone, or has stopped; whether the episode is stored is unknown."""


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
        assert self._process.stdin is not None
        # A process that has been stopped takes nothing, and a plain write would wait for ever.
        os.set_blocking(self._process.stdin.fileno(), False)
        # Linux has it. As it comes, a pipe takes 64 kB, so that both wake each other a hundred
        # times an episode.
        with suppress(AttributeError, OSError):
            fcntl.fcntl(self._process.stdin, fcntl.F_SETPIPE_SZ, _WRITTEN_BYTES)

    @property
    def process_id(self) -> int:
        """The process id that the operating system gave."""
        return self._process.pid

    def append_arrays(self, recorded: Recorded) -> None:
        """Store an episode as `EpisodeStore.keep` does.

        Raises StoreError as that, and WriterLostError where the process is gone, or does nothing
        for `PATIENCE_S`, after which it is ended.
        """
        answers = self._process.stdout
        assert answers is not None
        try:
            for message in messages(recorded):
                self._send(message)
            self._wait(answers, select.POLLIN)
            told = pickle.load(answers)
        except (BrokenPipeError, EOFError, pickle.UnpicklingError) as broken:
            raise WriterLostError(
                f"the process that writes into {self.path} ended with code {self._process.wait()}"
            ) from broken
        if told is not None:
            raise StoreError(told)

    def close(self) -> None:
        """End the process, which has nothing to do when `append_arrays` has returned."""
        self._process.kill()
        # What a broken pipe did not take was told of by `append_arrays`.
        with suppress(BrokenPipeError), self._process:
            pass

    def _send(self, message: memoryview) -> None:
        requests = self._process.stdin
        assert requests is not None
        while message:
            self._wait(requests, select.POLLOUT)
            sent = os.write(requests.fileno(), message[:_WRITTEN_BYTES])
            message = message[sent:]

    def _wait(self, pipe: IO[bytes], event: int) -> None:
        poll = select.poll()
        poll.register(pipe, event)
        if not poll.poll(1e3 * PATIENCE_S):
            self._process.kill()
            raise WriterLostError(
                f"the process that writes into {self.path} did nothing for {PATIENCE_S:g} s and "
                "was ended"
            )


def messages(recorded: Recorded) -> Iterator[memoryview]:
    """Yield what a writing process is sent of an episode, one piece after the other.

    Raises StoreError, before the first, where its arrays are not those of its header.
    """
    header, arrays = recorded.header, recorded.arrays
    require_layout(header, arrays)
    films = [spec for spec in layout(header) if spec.is_film]
    paths = {spec.path for spec in films}
    rest = {path: array for path, array in arrays.items() if path not in paths}
    yield memoryview(pickle.dumps(Recorded(header, rest), pickle.HIGHEST_PROTOCOL))
    for spec in films:
        for place in places(spec.shape, spec.chunks):
            block = np.ascontiguousarray(arrays[spec.path][box(place, spec.chunks)[:1]])
            if block.size:
                yield block.data.cast("B")


def serve(path: str, requests: IO[bytes], answers: IO[bytes]) -> None:
    """Adopt what comes until no more does, and answer each with None or with what went wrong."""
    # Its parent may be killed at any moment: half a request is none, and nobody hears an answer.
    with suppress(EOFError, pickle.UnpicklingError, BrokenPipeError):
        while True:
            columns: Recorded = pickle.load(requests)
            films = {
                spec.path: _Film(spec, requests) for spec in layout(columns.header) if spec.is_film
            }
            told = None
            try:
                whole = Recorded(columns.header, {**columns.arrays, **films})
                EpisodeStore(path).keep(whole)
            except EOFError:
                raise
            except SheathError as error:
                told = str(error)
            except Exception as error:
                told = f"cannot write into {path} ({type(error).__name__}: {error})"
            for film in films.values():
                film.drain()
            pickle.dump(told, answers, pickle.HIGHEST_PROTOCOL)
            answers.flush()


class _Film:
    """Frames that come through a pipe, each block once and in order."""

    def __init__(self, spec: ArraySpec, pipe: IO[bytes]) -> None:
        self.shape = spec.shape
        self.dtype = np.dtype(spec.dtype)
        self._spec = spec
        self._pipe = pipe
        self._taken = 0
        """frames"""

    def __getitem__(self, rows: tuple[slice, ...]) -> NDArray:
        """Return the next block of frames; EOFError where no more come."""
        start, stop, _ = rows[0].indices(self.shape[0])
        assert start == self._taken
        self._taken = stop
        block = np.empty((stop - start, *self.shape[1:]), self.dtype)
        left = block.reshape(-1).view(np.uint8).data
        while left:
            got = self._pipe.readinto(left)  # type: ignore[attr-defined] - a pipe has it
            if not got:
                raise EOFError
            left = left[got:]
        return block

    def drain(self) -> None:
        """Take what has not been asked for."""
        for place in places(self.shape, self._spec.chunks):
            rows = box(place, self._spec.chunks)[:1]
            if rows[0].start >= self._taken:
                self[rows]


def _search_path() -> list[str]:
    # An empty entry is the working directory.
    return [entry or str(Path.cwd()) for entry in sys.path]
