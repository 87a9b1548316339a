"""One episode as one zarr (format 3) group."""

from pathlib import Path, PurePosixPath

import numpy as np
import zarr
from numpy.typing import NDArray
from zarr.storage import StorePath

from sheath_manip.dataset.attributes import to_attributes
from sheath_manip.dataset.faults import REMEDY, FaultError, FaultKind
from sheath_manip.dataset.header import Header
from sheath_manip.dataset.layout import Arrays, ArraySpec, layout
from sheath_manip.dataset.zarr_files import array_files, group_files, within

FRAMES_PER_CHUNK = 64
"""Chunks of single frames take ten times as long to write and compress far worse."""


def episode_files(header: Header, arrays: Arrays) -> dict[str, bytes]:
    """The files of an episode's group, by their paths in it."""
    files = group_files(to_attributes(header))
    for spec in layout(header):
        for parent in reversed(PurePosixPath(spec.path).parents[:-1]):
            files |= within(str(parent), group_files({}))
        files |= within(spec.path, array_files(arrays[spec.path], _chunks(spec)))
    return files


def read_array(name: str, group: Path | StorePath, spec: ArraySpec) -> NDArray:
    """The array `spec` of the episode `name`, whose zarr group is at `group`; raises FaultError."""
    try:
        array = zarr.open_array(group, path=spec.path, mode="r", zarr_format=3)
    except FileNotFoundError as error:
        raise FaultError(
            name, FaultKind.MISSING, f"the array {spec.path} is missing; {REMEDY}"
        ) from error
    except Exception as error:
        raise _unreadable(name, spec, error) from error
    if array.shape != spec.shape or array.dtype != np.dtype(spec.dtype):
        raise FaultError(
            name,
            FaultKind.MISMATCH,
            f"{spec.path} is {array.dtype} {array.shape}; "
            f"its header wants {spec.dtype} {spec.shape}; {REMEDY}",
        )
    if array.nchunks_initialized != array.nchunks:
        # zarr itself would fill the gap with zeros.
        raise FaultError(
            name,
            FaultKind.MISSING,
            f"{spec.path} has {array.nchunks_initialized} of {array.nchunks} chunks; {REMEDY}",
        )
    try:
        return np.asarray(array[...])
    except Exception as error:
        raise _unreadable(name, spec, error) from error


def _chunks(spec: ArraySpec) -> tuple[int, ...]:
    """Images in blocks of frames; every other array is small and one chunk."""
    # zarr refuses a chunk of length 0, which an array without features would ask for.
    whole = tuple(max(1, size) for size in spec.shape)
    if spec.is_image and len(spec.shape) == 4:
        return (min(FRAMES_PER_CHUNK, whole[0]), *whole[1:])
    return whole


def _unreadable(name: str, spec: ArraySpec, error: Exception) -> FaultError:
    """Whatever zarr and its codecs raise (they share no class) as one line."""
    reason = str(error).splitlines()[0] if str(error) else type(error).__name__
    return FaultError(
        name, FaultKind.UNREADABLE, f"{spec.path} does not decode ({reason}); {REMEDY}"
    )
