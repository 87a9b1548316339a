"""Times what a program promises, on a machine that has other things to do as well."""

import time
from collections.abc import Iterable
from pathlib import Path


class Stopwatch:
    """Counts the seconds since it was made, without those that were spent waiting for a core.

    Of this process, and of the `others` (by their number) that take part in what is promised. So a
    promise in seconds is judged by what the program does: computing, sleeping and waiting for
    another thread count in full. Where the kernel does not tell of waiting, all of it counts.
    """

    def __init__(self, others: Iterable[int] = ()) -> None:
        self._tasks = [Path(f"/proc/{process}/task") for process in ("self", *others)]
        self._began_s = time.monotonic()
        self._waited_s = _waited_s(self._tasks)

    @property
    def took_s(self) -> float:
        """Seconds so far, as on a machine that is free."""
        wall_s = time.monotonic() - self._began_s
        waited_s = sum(
            now_s - self._waited_s.get(thread, 0.0)
            for thread, now_s in _waited_s(self._tasks).items()
        )
        return max(0.0, wall_s - waited_s)


def _waited_s(tasks: Iterable[Path]) -> dict[str, float]:
    """Of each thread of those processes, how long it was ready to run and had no core."""
    waited_s = {}
    for task in (each for process in tasks for each in process.glob("*/schedstat")):
        try:
            # Computing, waiting (both in ns), and how often it ran.
            waited_s[task.parent.name] = int(task.read_text().split()[1]) / 1e9
        except (OSError, IndexError, ValueError):
            continue
    return waited_s
