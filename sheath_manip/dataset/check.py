"""Looking for everything that is wrong with a store, chunk by chunk."""

from pathlib import PurePosixPath

from sheath_manip.dataset.attributes import GROUP_FILE
from sheath_manip.dataset.faults import REMEDY, Fault, FaultError, FaultKind
from sheath_manip.dataset.group import MOST_METADATA_BYTES, array_paths
from sheath_manip.dataset.header import Header
from sheath_manip.dataset.layout import layout
from sheath_manip.dataset.reader import EpisodeReader
from sheath_manip.dataset.steps import content_faults, content_remarks
from sheath_manip.files.bounded_json import parse_json


def check(reader: EpisodeReader) -> list[Fault]:
    """Every fault in a store; decompresses all of it. A NaN score is none."""
    return [
        *reader.entry_faults(),
        *(fault for name in reader.names() for fault in check_episode(reader, name)),
    ]


def check_episode(reader: EpisodeReader, name: str) -> list[Fault]:
    """Every fault of the episode `name`, and remarks on what it holds."""
    try:
        header = reader.header(name)
    except FaultError as error:
        return [error.fault]
    arrays, faults = {}, [*_place_faults(reader, name), *_folder_faults(reader, name, header)]
    for spec in layout(header):
        try:
            # Any pixel is as good as another: to decode is all that is asked of an image.
            if spec.is_image:
                reader.require_whole(name, spec)
            else:
                arrays[spec.path] = reader.array(name, spec, thorough=True)
        except FaultError as error:
            faults.append(error.fault)
    if faults:
        return faults
    # Only of an episode that is whole can the values be told right or wrong.
    return [*content_faults(header, arrays), *content_remarks(header, arrays)]


def require_sound_episode(reader: EpisodeReader, name: str) -> None:
    """Raise FaultError at the first fault of the episode `name` that affects data."""
    for fault in check_episode(reader, name):
        if fault.damaging:
            raise FaultError(fault.name, fault.kind, fault.text)


def _place_faults(reader: EpisodeReader, name: str) -> list[Fault]:
    try:
        reader.require_intact(name)
    except FaultError as error:
        return [error.fault]
    return []


def _folder_faults(reader: EpisodeReader, name: str, header: Header) -> list[Fault]:
    """What is wrong with the folders around the arrays, which reading an array does not ask for."""
    specs = layout(header)
    folders = {folder for spec in specs for folder in PurePosixPath(spec.path).parents}
    groups = {(folder / GROUP_FILE).as_posix() for folder in folders}
    files = reader.files(name)
    foreign = files.keys() - groups
    for spec in specs:
        foreign -= array_paths(spec)
    return [
        *(
            Fault(name, FaultKind.ODD_FILE, f"{path} is {kind}, which is not followed; {REMEDY}")
            for path, kind in reader.odd_files(name).items()
        ),
        *(
            Fault(name, FaultKind.FOREIGN, f"{file} belongs to none of its arrays; move it away")
            for file in sorted(foreign)
        ),
        *(
            fault
            for group in sorted(groups)
            for fault in _group_faults(reader, name, group, group in files)
        ),
    ]


def _group_faults(reader: EpisodeReader, name: str, file: str, is_there: bool) -> list[Fault]:
    if file == GROUP_FILE:
        # Its header has been read.
        return []
    if not is_there:
        return [Fault(name, FaultKind.MISSING, f"the group file {file} is missing; {REMEDY}")]
    try:
        group = parse_json(reader.content(name, file, MOST_METADATA_BYTES))
    except FaultError as error:
        return [error.fault]
    except ValueError as error:
        reason = f"{file} does not decode ({error}); {REMEDY}"
        return [Fault(name, FaultKind.UNREADABLE, reason)]
    if group != {"attributes": {}, "zarr_format": 3, "node_type": "group"}:
        return [Fault(name, FaultKind.MISMATCH, f"{file} is no zarr group; {REMEDY}")]
    return []
