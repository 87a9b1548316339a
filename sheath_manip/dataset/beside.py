"""What lies in a store's directory beside its episodes."""

from pathlib import Path

from sheath_manip.dataset.faults import Fault, FaultKind
from sheath_manip.dataset.index import INDEX
from sheath_manip.dataset.marker import MARKER
from sheath_manip.dataset.marks import is_marks_name
from sheath_manip.dataset.moment_notes import NOTES
from sheath_manip.dataset.naming import LEFTOVER_PREFIX
from sheath_manip.dataset.places import is_episode
from sheath_manip.dataset.rooted_files import entries_now, kind_of

THUMBNAILS = "sheath-thumbnails"
"""a folder of pictures, which are made anew where it is deleted"""
_OWN = (MARKER, INDEX, NOTES, THUMBNAILS)


def faults_beside_episodes(store: Path) -> list[Fault]:
    """Return the leftovers of recordings, and what does not belong into a store's directory."""
    faults = []
    for entry, status in entries_now(store):
        name, odd = entry.name, kind_of(status)
        if name.startswith(LEFTOVER_PREFIX):
            text = "a recording in progress or cut off; `sheath data repair` sweeps it away"
            faults.append(Fault(name, FaultKind.LEFTOVER, text))
        elif odd:
            text = f"{odd}, which is not followed; put there what it stands for, or delete it"
            faults.append(Fault(name, FaultKind.ODD_FILE, text))
        elif not (name in _OWN or is_marks_name(name) or is_episode(name, status)):
            text = "neither an episode nor the store's own; move it away"
            faults.append(Fault(name, FaultKind.FOREIGN, text))
    return faults
