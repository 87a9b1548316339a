"""Writing episodes for another tool: all of it appears at once, or nothing does."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from sheath_manip.dataset.compatibility import RecordedSpec, remarks
from sheath_manip.dataset.disk import require_room
from sheath_manip.dataset.durable import sync_tree
from sheath_manip.dataset.exchange.formats import writer_of
from sheath_manip.dataset.exchange.selection import Selection, selected
from sheath_manip.dataset.header import Header
from sheath_manip.dataset.reader import EpisodeReader
from sheath_manip.dataset.recorded import Recorded
from sheath_manip.exceptions import StoreError
from sheath_manip.files.outputs import written_aside
from sheath_manip.types import Outcome


@dataclass(frozen=True)
class Exported:
    """What was written."""

    episodes: int
    steps: int
    remarks: tuple[str, ...] = ()
    """what must be told of episodes that may lie together all the same"""


ROOM = 3
"""Before an episode is written, that many times its arrays must be free: robomimic holds each
observation twice, and no compression may be counted on."""


def export(
    reader: EpisodeReader,
    target: Path,
    format: str,
    selection: Selection,
    report: Callable[[str], None] = lambda _: None,
) -> Exported:
    """Write what `selection` takes of `reader` to `target`, where nothing may be yet.

    `format` is a name in FORMATS; `report` is told the outcome of each episode. Raises StoreError
    where `target` exists or cannot be written, where an episode is damaged or does not fit the
    others, and where nothing is selected; then nothing is there.
    """
    if target.exists():
        raise StoreError(f"{target} exists, and it is kept; give a path where nothing is")
    write, headers = writer_of(format), list[Header]()

    def counted(episodes: Iterable[Recorded]) -> Iterator[Recorded]:
        for recorded in episodes:
            # What fails for want of room in the middle of a file may take the process with it.
            require_room(target.parent, ROOM * _bytes_of(recorded))
            headers.append(recorded.header)
            yield recorded
            report(recorded.header.outcome)

    try:
        with written_aside(target, replacing=False) as aside:
            write(aside, counted(selected(reader, selection)), selection.action)
            if aside.is_dir():
                sync_tree(aside)
    except (OSError, RuntimeError) as error:
        # HDF5 raises either where the disk is full.
        raise StoreError(f"cannot write {target} ({error}); nothing is left of it") from error
    steps = sum(header.length for header in headers)
    told = remarks((header.info.variant, RecordedSpec.of(header)) for header in headers)
    failed = sum(header.outcome is not Outcome.SUCCESS for header in headers)
    if failed:
        told += (f"{failed} of them did not succeed; --successes leaves such episodes out",)
    return Exported(len(headers), steps, told)


def _bytes_of(recorded: Recorded) -> int:
    return sum(array.nbytes for array in recorded.arrays.values())
