"""Looking for everything that is wrong with a store, chunk by chunk."""

import json
from pathlib import PurePosixPath

from sheath_manip.dataset.attributes import GROUP_FILE
from sheath_manip.dataset.faults import REMEDY, Fault, FaultError, FaultKind
from sheath_manip.dataset.header import Header
from sheath_manip.dataset.layout import layout
from sheath_manip.dataset.reader import EpisodeReader
from sheath_manip.dataset.steps import content_faults
from sheath_manip.exceptions import StoreError


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
    arrays, faults = {}, _folder_faults(reader, name, header)
    for spec in layout(header):
        try:
            array = reader.array(name, spec)
        except FaultError as error:
            faults.append(error.fault)
        else:
            # Any pixel is as good as another: to decode is all that is asked of an image.
            if not spec.is_image:
                arrays[spec.path] = array
    # Only of an episode that is whole can the values be told right or wrong.
    return faults or content_faults(header, arrays)


def _folder_faults(reader: EpisodeReader, name: str, header: Header) -> list[Fault]:
    """What is wrong with the folders around the arrays, which reading an array does not ask for."""
    arrays = {PurePosixPath(spec.path) for spec in layout(header)}
    folders = {folder for array in arrays for folder in array.parents}
    groups = {folder / GROUP_FILE for folder in folders}
    files = set(map(PurePosixPath, reader.files(name)))
    foreign = {file for file in files - groups if arrays.isdisjoint(file.parents)}
    return [
        *(
            Fault(name, FaultKind.FOREIGN, f"{file} belongs to none of its arrays; move it away")
            for file in sorted(foreign)
        ),
        *(fault for group in sorted(groups) for fault in _group_faults(reader, name, str(group))),
    ]


def _group_faults(reader: EpisodeReader, name: str, file: str) -> list[Fault]:
    if file not in reader.files(name):
        return [Fault(name, FaultKind.MISSING, f"the group file {file} is missing; {REMEDY}")]
    try:
        group = json.loads(reader.content(name, file))
    except FaultError as error:
        return [error.fault]
    except StoreError as error:
        return [Fault(name, FaultKind.MISSING, f"{error}; {REMEDY}")]
    except (ValueError, RecursionError) as error:
        reason = f"{file} does not decode ({error}); {REMEDY}"
        return [Fault(name, FaultKind.UNREADABLE, reason)]
    if not isinstance(group, dict) or group.get("node_type") != "group":
        return [Fault(name, FaultKind.MISMATCH, f"{file} is no zarr group; {REMEDY}")]
    return []
