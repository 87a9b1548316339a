"""The file of a checkpoint: an .npz of plain arrays with a JSON header, and no code in it.

What it says of itself is held against what it is before anything is read: the memory that a file
may ask for stands in proportion to its own size, whatever it declares.
"""

import hashlib
import io
import json
import math
import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from sheath_manip.exceptions import CheckpointError
from sheath_manip.files.nearest import nearest_beside
from sheath_manip.files.plain_files import open_plain
from sheath_manip.protocols import Arrays

WRITTEN_BY = "a file that `sheath train` or `sheath learn` wrote"
HEADER = "header"
DIGEST = "digest"
"""in the header: 64 hex digits over all the rest of the file"""
# The earliest date that a zip file can hold: equal content then gives equal bytes.
ZIP_DATE = (1980, 1, 1, 0, 0, 0)
SAMPLED_BYTES = 1 << 16
"""of an array, by which it is told whether compressing it pays"""
MOST_ARRAYS = 20_000
MOST_DIMENSIONS = 8
SLACK_BYTES = 64 << 20
MOST_TIMES_LARGER = 200
"""Unpacked, a file may take `SLACK_BYTES`, and so many times its own size on top: binary features
take 50 times theirs."""
KINDS = "biufUS"
"""of numpy's dtypes: booleans, whole numbers, floats and text"""
MOST_ITEM_BYTES = 8
"""of a number: what is longer has another meaning on another machine"""
NEVER_CHOSEN = "biases"
"""the name of the one array in which minus infinity has a meaning: no label asked for the choice"""


def write_arrays(file: IO[bytes], header: Mapping[str, Any], arrays: Arrays) -> None:
    """Write a header that JSON keeps, and the arrays in the order of their names.

    Raises CheckpointError for an array that `read_arrays` would not take.
    """
    for name, array in arrays.items():
        require_finite(name, array)
        if (fault := _dtype_fault(array.dtype)) is not None:
            raise CheckpointError(f"{name}: {fault}")
    ordered = {name: np.asarray(arrays[name]) for name in sorted(arrays)}
    sealed = {**header, DIGEST: digest_of(header, ordered)}
    written = {HEADER: np.array(json.dumps(sealed, sort_keys=True)), **ordered}
    with zipfile.ZipFile(file, "w") as archive:
        for name, array in written.items():
            buffer = io.BytesIO()
            npy.write_array(buffer, array, allow_pickle=False)
            content = buffer.getvalue()
            info = zipfile.ZipInfo(f"{name}.npy", ZIP_DATE)
            archive.writestr(info, content, _compression(content))


def read_arrays(path: Path) -> tuple[dict[str, Any], dict[str, NDArray]]:
    """Return the header and the arrays of the file at `path`.

    Raises CheckpointError where there is none, where it asks for more memory than it may, holds
    what is no plain array or no finite number, or is not what its digest was taken of.
    """
    try:
        with open_plain(path) as file, zipfile.ZipFile(file) as archive:
            arrays = _unpacked(path, archive, path.stat().st_size)
    except FileNotFoundError as error:
        raise CheckpointError(
            f"no checkpoint at {path}; wanted {WRITTEN_BY}{nearest_beside(path)}"
        ) from error
    except CheckpointError:
        raise
    except Exception as error:
        # zipfile, zlib and numpy share no class of errors, and some of their words lead astray.
        found = str(error) if isinstance(error, OSError) else "no zip of arrays, or one cut short"
        raise CheckpointError(
            f"{path} cannot be read as a checkpoint ({found}); wanted a file that `sheath train` "
            "or an experiment wrote"
        ) from error
    return _header(path, arrays.pop(HEADER, np.array("{}"))), arrays


def require_digest(path: Path, header: Mapping[str, Any], arrays: Arrays) -> None:
    """Raise CheckpointError unless the header holds the digest of all the rest."""
    rest = {name: value for name, value in header.items() if name != DIGEST}
    if header.get(DIGEST) != digest_of(rest, arrays):
        raise CheckpointError(
            f"{path} is not what was written: its digest belongs to other content; copy it again, "
            "or train again"
        )


def digest_of(header: Mapping[str, Any], arrays: Arrays) -> str:
    """Return 64 hex digits, the same for the same header and arrays of the same bytes."""
    digest = hashlib.sha256(json.dumps(header, sort_keys=True).encode())
    for name in sorted(arrays):
        array = np.asarray(arrays[name])
        digest.update(f"{name} {array.dtype.str} {array.shape}\n".encode())
        digest.update(array.tobytes())
    return digest.hexdigest()


def require_finite(name: str, array: NDArray) -> None:
    """Raise CheckpointError where a number is none, or infinite."""
    array = np.asarray(array)
    if array.dtype.kind != "f":
        return
    fine = np.isfinite(array)
    if name.rpartition("/")[2] == NEVER_CHOSEN:
        fine |= np.isneginf(array)
    if not fine.all():
        place = np.unravel_index(int(np.argmin(fine)), array.shape)
        raise CheckpointError(
            f"{name}{list(map(int, place))} is {array[place]}; wanted finite numbers in all "
            f"{array.size} places, {int((~fine).sum())} are not: train again, and look for what "
            "is not finite in the data"
        )


def _unpacked(path: Path, archive: zipfile.ZipFile, file_bytes: int) -> dict[str, NDArray]:
    entries = archive.infolist()
    names = [entry.filename.removesuffix(".npy") for entry in entries]
    most = SLACK_BYTES + MOST_TIMES_LARGER * file_bytes
    asked = sum(entry.file_size for entry in entries)
    if len(entries) > MOST_ARRAYS or len(set(names)) < len(names):
        raise CheckpointError(
            f"{path} has {len(entries)} arrays of {len(set(names))} names; wanted at most "
            f"{MOST_ARRAYS}, each once"
        )
    if asked > most:
        raise CheckpointError(
            f"{path} has {file_bytes} bytes and asks for {asked} unpacked; wanted at most {most}"
        )
    arrays = {}
    for name, entry in zip(names, entries, strict=True):
        try:
            arrays[name] = _array(archive, entry)
            require_finite(name, arrays[name])
        except CheckpointError as error:
            raise CheckpointError(f"{path} is broken: {error}") from error
    return arrays


def _array(archive: zipfile.ZipFile, entry: zipfile.ZipInfo) -> NDArray:
    with archive.open(entry) as file:
        version = npy.read_magic(file)
        read = npy.read_array_header_1_0 if version == (1, 0) else npy.read_array_header_2_0
        shape, fortran, dtype = read(file)
        if (fault := _dtype_fault(dtype)) is not None:
            raise CheckpointError(f"{entry.filename}: {fault}")
        size = math.prod(shape)
        # Held against what the zip declares, which is bounded, before memory is taken.
        if len(shape) > MOST_DIMENSIONS or file.tell() + size * dtype.itemsize != entry.file_size:
            raise CheckpointError(
                f"{entry.filename} has {entry.file_size} bytes; wanted those of {dtype} "
                f"{shape!s:.80}"
            )
        content = bytearray(file.read())
        if len(content) != size * dtype.itemsize:
            raise CheckpointError(f"{entry.filename} is cut short")
    flat = np.frombuffer(content, dtype, size)
    return flat.reshape(shape, order="F" if fortran else "C")


def _dtype_fault(dtype: np.dtype) -> str | None:
    number = dtype.kind in "biuf"
    if dtype.kind in KINDS and not (number and dtype.itemsize > MOST_ITEM_BYTES):
        return None
    return f"it holds {dtype}, wanted booleans, numbers of at most 8 bytes or text"


def _header(path: Path, stored: NDArray) -> dict[str, Any]:
    try:
        header = json.loads(str(stored))
    except (ValueError, RecursionError) as error:
        raise CheckpointError(f"{path} has a header that does not decode ({error})") from error
    if not isinstance(header, dict):
        raise CheckpointError(f"{path} is no checkpoint; wanted {WRITTEN_BY}")
    return header


def _compression(content: bytes) -> int:
    """Deflate for what then has half the size at most: binary features have a fiftieth.

    Network weights and image features would not even get a tenth smaller, for a second each.
    """
    sample = content[:SAMPLED_BYTES]
    pays = 2 * len(zlib.compress(sample, 1)) < len(sample)
    return zipfile.ZIP_DEFLATED if pays else zipfile.ZIP_STORED
