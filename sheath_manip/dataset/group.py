"""One episode as one zarr (format 3) group."""

import os
from collections.abc import Callable, Iterator
from pathlib import PurePosixPath

import numpy as np
from numpy.typing import NDArray

from sheath_manip.dataset.attributes import GROUP_FILE, to_attributes
from sheath_manip.dataset.digests import ArrayDigest, ChecksumDigest, Seals, sealed
from sheath_manip.dataset.faults import REMEDY, FaultError, FaultKind
from sheath_manip.dataset.layout import ArraySpec, layout
from sheath_manip.dataset.recorded import Recorded
from sheath_manip.dataset.zarr_files import (
    METADATA,
    File,
    array_metadata,
    box,
    chunk_key,
    decoded,
    encoded,
    group_file,
    metadata_file,
    places,
)
from sheath_manip.exceptions import StoreError
from sheath_manip.files.bounded_json import parse_json

Content = Callable[[str, int], bytes]
"""Gives what is in a file of an episode, of at most so many bytes; raises StoreError, and
FaultError where it is damaged."""
MOST_METADATA_BYTES = 64 << 10
MEMORY_SHARE = 0.5
"""of the machine's, that one array may take"""


def episode_files(recorded: Recorded) -> Iterator[File]:
    """Yield the files of an episode's group, by their paths in it, the header last.

    Rows are asked for in the order of `layout` and of time, a block at a time: what is yielded and
    forgotten takes no memory.
    """
    digests, checksums = dict[str, str](), dict[str, str]()
    groups = set[PurePosixPath]()
    for spec in layout(recorded.header):
        for group in reversed(PurePosixPath(spec.path).parents[:-1]):
            if group not in groups:
                groups.add(group)
                yield f"{group}/{METADATA}", group_file({})
        digest, rows = ArrayDigest(spec), recorded.arrays[spec.path]
        checksum = ChecksumDigest(spec)
        yield f"{spec.path}/{METADATA}", metadata_file(spec.shape, spec.dtype, spec.chunks)
        for place in places(spec.shape, spec.chunks):
            # Only the first axis is ever split.
            part = np.asarray(rows[box(place, spec.chunks)[:1]], order="C")
            digest.update(part)
            chunk = encoded(part, spec.chunks)
            checksum.update(chunk)
            yield f"{spec.path}/{chunk_key(place)}", chunk
        digests[spec.path], checksums[spec.path] = digest.hexdigest(), checksum.hexdigest()
    seals = Seals(digests, checksums)
    yield GROUP_FILE, group_file(sealed(to_attributes(recorded.header), seals))


def array_paths(spec: ArraySpec) -> set[str]:
    """Return the files of an array, by their paths in the episode's group."""
    keys = map(chunk_key, places(spec.shape, spec.chunks))
    return {f"{spec.path}/{file}" for file in (METADATA, *keys)}


def read_array(name: str, spec: ArraySpec, content: Content, thorough: bool = False) -> NDArray:
    """The array `spec` of the episode `name`; raises StoreError, and FaultError for damage."""
    require_memory(name, spec.path, spec.bytes)
    whole = np.empty(spec.shape, spec.dtype)
    for part, block in blocks(name, spec, content, thorough, whole):
        if not np.may_share_memory(block, whole):
            whole[part] = block
    return whole


def blocks(
    name: str,
    spec: ArraySpec,
    content: Content,
    thorough: bool = True,
    into: NDArray | None = None,
) -> Iterator[tuple[tuple[slice, ...], NDArray]]:
    """Yield the parts of an array of the episode `name`, one at a time, and where each belongs.

    Raises StoreError, and FaultError for damage: at the end also where what came is not what was
    recorded. That is told by the blocks' checksums, against which each is held as it is decoded;
    if `thorough`, or where the recording tells no checksums, by a digest of all values, too. Blocks
    are decoded into the array `into`, where they are whole.
    """
    _require_metadata(name, spec, content)
    checksum = ChecksumDigest(spec) if spec.checksum else None
    digest = ArrayDigest(spec) if spec.digest and (thorough or checksum is None) else None
    chunk = ArraySpec(spec.path, spec.chunks, spec.dtype)
    # What cannot be compressed grows by less than that.
    most_bytes = chunk.bytes + chunk.bytes // 64 + 1024
    for place in places(spec.shape, spec.chunks):
        key, inside = f"{spec.path}/{chunk_key(place)}", box(place, spec.chunks)
        target = None if into is None else into[inside]
        if target is not None and target.shape != spec.chunks:
            target = None
        encoded_block = content(key, most_bytes)
        try:
            block = decoded(encoded_block, spec.dtype, spec.chunks, target)
            if checksum is not None:
                checksum.update(encoded_block)
        except ValueError as error:
            raise FaultError(
                name, FaultKind.UNREADABLE, f"{spec.path} does not decode ({error}); {REMEDY}"
            ) from error
        rest = tuple(size - part.start for size, part in zip(spec.shape, inside, strict=True))
        block = np.asarray(block[tuple(map(slice, rest))], order="C")
        if digest is not None:
            digest.update(block)
        yield inside, block
    if (checksum is not None and checksum.hexdigest() != spec.checksum) or (
        digest is not None and digest.hexdigest() != spec.digest
    ):
        raise FaultError(
            name,
            FaultKind.MISMATCH,
            f"{spec.path} holds other values than were recorded: its digest is another; {REMEDY}",
        )


def require_memory(name: str, what: str, bytes: int) -> None:
    """Raise StoreError where so much is more than one array may take on this machine."""
    most = MEMORY_SHARE * os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    if bytes > most:
        raise StoreError(
            f"{name}: {what} takes {bytes / 1e9:.1f} GB in memory, wanted at most {most / 1e9:.1f} "
            "GB, half of what this machine has; read it on a larger one, or record shorter episodes"
        )


def _require_metadata(name: str, spec: ArraySpec, content: Content) -> None:
    try:
        told = content(f"{spec.path}/{METADATA}", MOST_METADATA_BYTES)
        # To the byte as it is written here: nothing has to be parsed.
        if told == metadata_file(spec.shape, spec.dtype, spec.chunks):
            return
        metadata = parse_json(told)
    except FaultError as error:
        if error.fault.kind is not FaultKind.MISSING:
            raise
        raise FaultError(
            name, FaultKind.MISSING, f"the array {spec.path} is missing; {REMEDY}"
        ) from error
    except ValueError as error:
        raise FaultError(
            name,
            FaultKind.UNREADABLE,
            f"{spec.path}/{METADATA} does not decode ({error}); {REMEDY}",
        ) from error
    wanted = array_metadata(spec.shape, spec.dtype, spec.chunks)
    if metadata == wanted:
        return
    if not isinstance(metadata, dict) or not wanted.keys() <= metadata.keys():
        raise FaultError(
            name, FaultKind.UNREADABLE, f"{spec.path} does not decode (no zarr array); {REMEDY}"
        )
    kind, shape = metadata["data_type"], metadata["shape"]
    found = f"{kind} ({', '.join(map(str, shape))})" if isinstance(shape, list) else "no array"
    differing = ", ".join(key for key in wanted if metadata[key] != wanted[key]) or "more is told"
    raise FaultError(
        name,
        FaultKind.MISMATCH,
        f"{spec.path} is {found:.80}; its header wants {spec.dtype} {spec.shape}, stored as is "
        f"usual here (unlike that: {differing}); {REMEDY}",
    )
