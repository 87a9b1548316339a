"""HDF5 files of others: only what lies in the file itself, and only what HDF5 itself decodes.

HDF5 knows links to other files, datasets whose bytes lie in other files or are put together from
others, and filters that it loads as plugins; none of these is followed here.
"""

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from sheath_manip.dataset.exchange.limits import Limits
from sheath_manip.exceptions import StoreError

FILTERS = {1: "gzip", 2: "shuffle", 3: "fletcher32", 32000: "lzf"}
"""those that HDF5 and h5py bring with them, by their numbers"""
MOST_DEEP = 8
MOST_OBJECTS = 100_000
"""in one group, all that is below it counted"""
MOST_ATTRIBUTE_BYTES = 16 << 20
MOST_ITEM_BYTES = 8
MOST_NAME = 256
"""letters of a name in a list"""
TEXT_BYTES = 100
"""that Python takes for a text beside its letters"""


def member(group: h5py.Group, path: str) -> Any:
    """The group or dataset at `path`; StoreError where a link leads there, or nothing does."""
    found: Any = group
    for name in path.split("/"):
        link = found.get(name, getlink=True) if isinstance(found, h5py.Group) else None
        if link is None:
            raise StoreError(f"{path} is not in {group.name}")
        if not isinstance(link, h5py.HardLink):
            raise StoreError(f"{path} of {group.name} is a {type(link).__name__}; wanted no links")
        found = found[name]
    return found


def datasets(group: h5py.Group, limits: Limits) -> Iterator[tuple[str, h5py.Dataset]]:
    """Yield path and dataset of all that is below `group`; raises StoreError as `member`."""
    waiting, seen = [("", group)], set[int]()
    while waiting:
        path, above = waiting.pop()
        for name in above:
            limits.require_time()
            found = member(above, str(name))
            # Of an object of the file, the same by whatever name.
            address = hash(found.id)
            below = f"{path}{name}"
            if address in seen or below.count("/") >= MOST_DEEP or len(seen) >= MOST_OBJECTS:
                raise StoreError(f"{below} of {group.name} is there twice, or nested too deep")
            seen.add(address)
            if isinstance(found, h5py.Group):
                waiting.append((f"{below}/", found))
            elif isinstance(found, h5py.Dataset):
                yield below, found


def dataset_bytes(dataset: h5py.Dataset) -> int:
    """Return what a dataset takes in memory.

    Raises StoreError where its bytes are elsewhere, or it holds what is no plain number.
    """
    require_here(dataset)
    kind = dataset.dtype
    if kind.kind not in "biuf" or kind.itemsize > MOST_ITEM_BYTES:
        raise StoreError(f"{dataset.name} holds {kind}; wanted booleans or numbers")
    shapes = [dataset.shape, *([dataset.chunks] if dataset.chunks else [])]
    return max(math.prod(shape) for shape in shapes) * kind.itemsize


def read(dataset: h5py.Dataset, limits: Limits) -> NDArray:
    """Return all of a dataset; raises StoreError as `dataset_bytes`, and where it is too large."""
    limits.require_memory(str(dataset.name), dataset_bytes(dataset))
    return np.asarray(dataset[()])


def counted(name: str) -> tuple[int, str]:
    """Return what sorts demo_0, demo_1, … as they are counted; anything else comes after."""
    digits = name.rpartition("_")[2]
    return (int(digits) if digits.isdecimal() and len(digits) < 10 else 10**9, name)


def is_blobs(dataset: Any) -> bool:
    """Whether a dataset is a list of bytes of any length, such as encoded images."""
    if not isinstance(dataset, h5py.Dataset) or len(dataset.shape) != 1:
        return False
    return h5py.check_vlen_dtype(dataset.dtype) == np.uint8


def read_blobs(dataset: h5py.Dataset, limits: Limits) -> list[bytes]:
    """Return a list of bytes; raises StoreError as `dataset_bytes`, and where it is too large."""
    require_here(dataset)
    blobs, total = [], 0
    # Two may be the same bytes of the file, so that its size is no bound.
    for row in range(dataset.shape[0]):
        blobs.append(dataset[row].tobytes())
        total += len(blobs[-1])
        limits.require_memory(str(dataset.name), total)
    return blobs


def read_names(dataset: Any, limits: Limits) -> tuple[str, ...]:
    """Return a list of short texts, as robomimic's masks are; StoreError for anything else."""
    is_list = isinstance(dataset, h5py.Dataset) and len(dataset.shape) == 1
    if not is_list or h5py.check_string_dtype(dataset.dtype) is None:
        raise StoreError(f"{dataset.name} is no list of names")
    require_here(dataset)
    limits.require_memory(str(dataset.name), dataset.shape[0] * (MOST_NAME + TEXT_BYTES))
    names = []
    # One by one: they may be of any length, and two the same bytes of the file.
    for row in range(dataset.shape[0]):
        limits.require_time()
        names.append(dataset[row].decode())
        if len(names[-1]) > MOST_NAME:
            raise StoreError(f"{dataset.name} has a name of {len(names[-1])} letters")
    return tuple(names)


def require_here(dataset: h5py.Dataset) -> None:
    """Raise StoreError where a dataset's bytes are elsewhere, or wait for a filter as a plugin."""
    layout = dataset.id.get_create_plist()
    # Before its shape, which a virtual one may have from other files.
    if dataset.is_virtual or layout.get_external_count():
        raise StoreError(f"{dataset.name} is kept in other files; wanted its bytes in this one")
    codes = [layout.get_filter(number)[0] for number in range(layout.get_nfilters())]
    if unknown := [code for code in codes if code not in FILTERS]:
        raise StoreError(
            f"{dataset.name} needs the filter {unknown[0]}; wanted {', '.join(FILTERS.values())}"
        )


def attribute(item: Any, name: str) -> Any:
    """Return an attribute that is one number or text; StoreError for none or another."""
    if name not in item.attrs:
        raise StoreError(f"{item.name} has no attribute {name!r}")
    stored = item.attrs.get_id(name)
    text = h5py.check_string_dtype(stored.dtype) is not None
    if math.prod(stored.shape) != 1 or not (text or stored.dtype.kind in "biuf"):
        raise StoreError(f"the attribute {name} of {item.name} is not one number or text")
    if stored.get_storage_size() > MOST_ATTRIBUTE_BYTES:
        raise StoreError(f"the attribute {name} of {item.name} is too large")
    value = item.attrs[name]
    return value[()] if isinstance(value, np.ndarray) and not value.shape else value


def open_file(path: Path) -> h5py.File:
    """Open a file to read; raises StoreError unless it is a plain one."""
    if not path.is_file():
        raise StoreError(f"wanted an HDF5 file at {path}, found none")
    return h5py.File(path, "r")
