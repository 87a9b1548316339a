"""How far an experiment is, and how long it has taken over all its sessions."""

import json
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from sheath_manip.files.json_files import write_json
from sheath_manip.learning.headway import HeadwayCount, left_words
from sheath_manip.protocols import HeadwayListener, Listener, Report
from sheath_manip.rollout.audience import Audience
from sheath_manip.types.work import Headway


class Stopwatch:
    """Wall time of a run, over all the sessions that it took."""

    def __init__(self, path: Path) -> None:
        self._path = path
        try:
            self._before_s = float(json.loads(path.read_text())["wall_s"])
        except (OSError, ValueError, KeyError, TypeError):
            self._before_s = 0.0
        self._begin_s = self._written_s = time.monotonic()

    def tick(self, force: bool = False) -> float:
        """The time so far, in seconds; written every few of them, so that a kill loses little."""
        now_s = time.monotonic()
        total_s = self._before_s + now_s - self._begin_s
        if force or now_s - self._written_s > 5.0:
            write_json(self._path, {"wall_s": total_s})
            self._written_s = now_s
        return total_s


def told_headway(listeners: Sequence[Listener]) -> Callable[[Headway], None]:
    """Return what tells those of `listeners` that want to know how far the whole run is."""
    audience = Audience([each for each in listeners if isinstance(each, HeadwayListener)])
    return lambda headway: audience.tell(lambda each: each.on_headway(headway))


@contextmanager
def shown_progress(
    console: Console, units: int, stopwatch: Stopwatch, listeners: Sequence[Listener] = ()
) -> Iterator[Report]:
    """A bar of `units`; what it yields counts one of them, and says which."""
    columns = (
        TextColumn("{task.description:32}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TextColumn("{task.fields[left]}"),
    )
    counted, tell = HeadwayCount(units, stopwatch.tick), told_headway(listeners)
    with Progress(*columns, console=console, transient=False) as progress:
        bar = progress.add_task("starting", total=units, left="")

        def report(text: str) -> None:
            headway = counted.count()
            left = left_words(headway)
            progress.update(bar, completed=headway.done, description=text, left=left)
            tell(headway)

        yield report
        progress.update(bar, completed=units, description="done", left="")
        tell(Headway(units, units))
