"""What lies in the directory of a store beside its episodes."""

from pathlib import Path

from sheath_manip.dataset.faults import Fault, FaultKind
from sheath_manip.dataset.marker import MARKER
from sheath_manip.dataset.marks import is_marks_name
from sheath_manip.dataset.naming import LEFTOVER_PREFIX, is_episode_name
from sheath_manip.dataset.rooted_files import kind_of


def entry_faults(store: Path) -> list[Fault]:
    """The leftovers, links and the like, and what does not belong into the directory `store`."""
    found = (_fault(entry) for entry in sorted(store.iterdir()))
    return [fault for fault in found if fault is not None]


def _fault(entry: Path) -> Fault | None:
    if entry.name.startswith(LEFTOVER_PREFIX):
        text = "a recording in progress or cut off; `sheath data repair` sweeps it away"
        return Fault(entry.name, FaultKind.LEFTOVER, text)
    odd = kind_of(entry.lstat())
    if odd:
        text = f"{odd}, which is not followed; put there what it stands for, or delete it"
        return Fault(entry.name, FaultKind.ODD_FILE, text)
    known = entry.name == MARKER or is_marks_name(entry.name)
    if known or (entry.is_dir() and is_episode_name(entry.name)):
        return None
    return Fault(
        entry.name, FaultKind.FOREIGN, "neither an episode nor the store's own; move it away"
    )
