"""Looking for everything that is wrong with a store, chunk by chunk."""

from sheath_manip.dataset.faults import REMEDY, Fault, FaultError, FaultKind
from sheath_manip.dataset.layout import layout
from sheath_manip.dataset.reader import EpisodeReader
from sheath_manip.dataset.steps import not_finite, require_known_codes


def check(reader: EpisodeReader) -> list[Fault]:
    """Every fault in a store; decompresses all of it. A NaN score is none."""
    return [
        *reader.entry_faults(),
        *(fault for name in reader.names() for fault in check_episode(reader, name)),
    ]


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
