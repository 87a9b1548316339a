"""Looking for everything that is wrong with a store, chunk by chunk."""

from pathlib import PurePosixPath

from sheath_manip.dataset.faults import REMEDY, Fault, FaultError, FaultKind
from sheath_manip.dataset.header import GROUP_FILE, Header
from sheath_manip.dataset.layout import layout
from sheath_manip.dataset.reader import EpisodeReader
from sheath_manip.dataset.steps import not_finite, require_counts, require_known_codes


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
    arrays, faults = {}, _foreign_files(reader, name, header)
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
        require_counts(header, arrays)
    except FaultError as error:
        faults.append(error.fault)
    faults += [
        Fault(name, FaultKind.NOT_FINITE, f"an action in {array!r} is not finite; {REMEDY}")
        for array in not_finite(arrays)
    ]
    return faults


def _foreign_files(reader: EpisodeReader, name: str, header: Header) -> list[Fault]:
    """One fault for each entry of the episode that belongs to none of its arrays."""
    own = {GROUP_FILE}
    for spec in layout(header):
        own |= {str(parent / GROUP_FILE) for parent in PurePosixPath(spec.path).parents}
        own.add(spec.path)
    foreign = {
        file
        for file in map(PurePosixPath, reader.files(name))
        if own.isdisjoint(map(str, (file, *file.parents)))
    }
    text = "belongs to none of the episode's arrays; move it away"
    return [Fault(name, FaultKind.FOREIGN, f"{file} {text}") for file in sorted(foreign)]
