"""An import in a process of its own, which a file may bring down, and nothing else with it.

Memory and time are bounded where arrays are read; but the structure of an HDF5 file is parsed in C,
by a library that asks nobody how long it may take, and packages add formats that we do not know.
"""

import json
import pickle
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import asdict
from pathlib import Path
from typing import IO

from sheath_manip.dataset.exchange.formats import limits_of, located, open_file
from sheath_manip.dataset.exchange.importing import Imported, Origin, import_episodes, staging_of
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import ParameterError, SetupError, SheathError, StoreError

GRACE_S = 10.0
"""for the start of the process"""
TIMES_AS_LONG = 5
"""as reading the file may take: what is read is also written"""

# What it imports is what this process imports, in a checkout as from a wheel.
_CODE = """
import sys
sys.path[:] = sys.argv[1:]
from sheath_manip.dataset.exchange.apart import serve
serve(sys.stdin.buffer, sys.stdout.buffer)
"""


def import_apart(format: str, path: Path, store: Path, origin: Origin | None) -> Imported:
    """Do as `import_episodes` does with a file of `format`, in another process.

    The directory `store` is made a store where there is none, and the file is one of its format.

    Raises what that raises, and StoreError where the process is ended by the file, or does not end
    in the time that the file's size allows.
    """
    path = located(format, path)
    most_s = TIMES_AS_LONG * limits_of(format, path).most_s + GRACE_S
    with _process(store) as process:
        request = pickle.dumps((format, path, store, origin))
        try:
            answer, _ = process.communicate(request, timeout=most_s)
        except subprocess.TimeoutExpired as error:
            raise StoreError(
                f"nothing is imported: importing {path} takes longer than {most_s:.0f} s, which is "
                "the most for a file of its size; split it"
            ) from error
    if not answer:
        raise StoreError(
            f"nothing is imported: reading {path} ended its process with code "
            f"{process.returncode}; the file is damaged, or means harm"
        )
    told = json.loads(answer)
    if "error" in told:
        raise ERRORS[told["kind"]](told["error"])
    return Imported(**{**told, "remarks": tuple(told["remarks"])})


ERRORS = {kind.__name__: kind for kind in (ParameterError, SetupError, StoreError)}
"""as what the process may say that it failed"""
MEMORY_TIMES = 4
"""as much as an episode may take: it is decoded, joined and compressed"""
MEMORY_BYTES = 4 << 30
"""for the libraries themselves, and what they put aside"""


def serve(requests: IO[bytes], answers: IO[bytes]) -> None:
    """Do one import, and say what came of it."""
    format, path, store, origin = pickle.load(requests)
    try:
        _bound_memory(limits_of(format, path).most_bytes)
        file = open_file(format, path)
        told = asdict(import_episodes(file, EpisodeStore.create(store), origin))
    except SheathError as error:
        kinds = (name for name, kind in ERRORS.items() if isinstance(error, kind))
        told = {"error": str(error), "kind": next(kinds, StoreError.__name__)}
    answers.write(json.dumps(told).encode())
    answers.flush()


def _bound_memory(episode_bytes: int) -> None:
    """Refuse what Parquet, films and images ask for beyond what an episode may take."""
    if sys.platform == "win32":
        # It has no such bound.
        return
    import resource

    most_bytes = MEMORY_BYTES + MEMORY_TIMES * episode_bytes
    _, hard_bytes = resource.getrlimit(resource.RLIMIT_DATA)
    if hard_bytes == resource.RLIM_INFINITY or most_bytes < hard_bytes:
        resource.setrlimit(resource.RLIMIT_DATA, (most_bytes, hard_bytes))


@contextmanager
def _process(store: Path) -> Iterator[subprocess.Popen]:
    """One that is gone at the end, with all that it had staged."""
    # An empty entry is the working directory.
    search_path = [entry or str(Path.cwd()) for entry in sys.path]
    process = subprocess.Popen(
        [sys.executable, "-P", "-c", _CODE, *search_path],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        # What it has to say is its answer.
        stderr=subprocess.DEVNULL,
        # Ctrl-C is for this process.
        start_new_session=True,
    )
    try:
        yield process
    finally:
        process.kill()
        with suppress(BrokenPipeError), process:
            pass
        for left in staging_of(store, process.pid):
            shutil.rmtree(left, ignore_errors=True)
