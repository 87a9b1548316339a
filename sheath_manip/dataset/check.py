"""Looking for everything that is wrong with a store, chunk by chunk."""

from sheath_manip.dataset.faults import REMEDY, Fault, FaultError, FaultKind
from sheath_manip.dataset.layout import layout
from sheath_manip.dataset.marker import MARKER
from sheath_manip.dataset.naming import LEFTOVER_PREFIX, is_episode_name
from sheath_manip.dataset.reader import EpisodeReader
from sheath_manip.dataset.steps import not_finite, require_known_codes
from sheath_manip.dataset.store import EpisodeStore


def check(store: EpisodeStore) -> list[Fault]:
    """Every fault in `store`; decompresses all of it. A NaN score is none."""
    return [
        *check_entries(store),
        *(fault for name in store.names() for fault in check_episode(store, name)),
    ]


def check_entries(store: EpisodeStore) -> list[Fault]:
    """The leftovers, and what does not belong into the directory."""
    faults = []
    for entry in sorted(store.path.iterdir()):
        if entry.name.startswith(LEFTOVER_PREFIX):
            text = "a recording in progress or cut off; `sheath data repair` sweeps it away"
            faults.append(Fault(entry.name, FaultKind.LEFTOVER, text))
        elif entry.name != MARKER and not (entry.is_dir() and is_episode_name(entry.name)):
            text = "neither an episode nor the store's own; move it away"
            faults.append(Fault(entry.name, FaultKind.FOREIGN, text))
    return faults


def check_episode(reader: EpisodeReader, name: str) -> list[Fault]:
    """Every fault of the episode `name`."""
    try:
        header = reader.header(name)
    except FaultError as error:
        return [error.fault]
    arrays, faults = {}, []
    for spec in layout(header):
        try:
            array = reader.array(name, spec)
        except FaultError as error:
            faults.append(error.fault)
        else:
            # Any pixel is as good as another: to decode is all that is asked of an image.
            if not spec.is_image:
                arrays[spec.path] = array
    if faults:
        return faults
    try:
        require_known_codes(header, arrays)
    except FaultError as error:
        faults.append(error.fault)
    faults += [
        Fault(name, FaultKind.NOT_FINITE, f"an action in {array!r} is not finite; {REMEDY}")
        for array in not_finite(arrays)
    ]
    return faults
