"""Ways to spoil the file of a checkpoint; each is seeded, and says what may come of it."""

import io
import json
import os
import struct
import warnings
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from sheath_manip.learning.checkpoint_file import read_arrays, write_arrays

Rng = np.random.Generator
Spoil = Callable[[Path, Rng], None]
"""Spoils the sound checkpoint at a path."""


def one_of(rng: Rng, options: Any) -> Any:
    return options[int(rng.integers(len(options)))]


def sealed(path: Path, header: dict[str, Any], arrays: Mapping[str, np.ndarray]) -> None:
    """Write another content with the digest that belongs to it, as who forges a file would."""
    header.pop("digest", None)
    with path.open("wb") as file:
        write_arrays(file, header, arrays)


def unsealed(path: Path, header: Any, arrays: Mapping[str, np.ndarray]) -> None:
    """Write another content without caring for the digest, nor for code in it."""
    text = header if isinstance(header, str) else json.dumps(header)
    content: dict[str, Any] = {"header": np.array(text), **arrays}
    with path.open("wb") as file:
        np.savez(file, allow_pickle=True, **content)


def cut(path: Path, rng: Rng) -> None:
    path.write_bytes(path.read_bytes()[: int(rng.integers(path.stat().st_size))])


def flip_bits(path: Path, rng: Rng) -> None:
    content = bytearray(path.read_bytes())
    for place in rng.integers(len(content), size=int(rng.integers(1, 9))):
        content[place] ^= 1 << int(rng.integers(8))
    path.write_bytes(bytes(content))


def overwrite(path: Path, rng: Rng) -> None:
    content = bytearray(path.read_bytes())
    start, length = int(rng.integers(len(content))), int(rng.integers(1, 3000))
    content[start : start + length] = rng.bytes(length)
    path.write_bytes(bytes(content))


def foreign(path: Path, rng: Rng) -> None:
    """Something else lies there."""
    path.unlink()
    kind = int(rng.integers(6))
    if kind == 0:
        os.mkfifo(path)
    elif kind == 1:
        path.mkdir()
    elif kind == 2:
        path.symlink_to(path)
    elif kind == 3:
        path.symlink_to("/dev/zero")
    elif kind == 4:
        path.write_bytes(rng.bytes(int(rng.integers(3000))))
    else:
        path.write_bytes(b"PK\x05\x06" + bytes(18))


def other_shape(path: Path, rng: Rng) -> None:
    header, arrays = read_arrays(path)
    name = one_of(rng, sorted(arrays))
    array = arrays[name]
    others = [
        array[None],
        array.reshape(-1),
        array.reshape(-1)[:0],
        np.concatenate([array.reshape(-1), array.reshape(-1)[:1]]),
        np.zeros((2, 3, 4), array.dtype),
        np.array(0, array.dtype),
        np.resize(array, tuple(n + 1 for n in array.shape) or (3,)),
        array.T if array.ndim > 1 and len(set(array.shape)) > 1 else array[..., None],
    ]
    sealed(path, header, {**arrays, name: one_of(rng, others)})


def other_type(path: Path, rng: Rng) -> None:
    header, arrays = read_arrays(path)
    name = one_of(rng, sorted(arrays))
    array = arrays[name]
    with np.errstate(all="ignore"):
        others = [
            array.astype("U8"),
            array.astype("S8"),
            array.astype(complex),
            array.astype(object),
            array.astype(np.longdouble),
            np.zeros(array.shape, "M8[s]"),
            np.zeros(array.shape, [("a", "f4"), ("b", "i8")]),
            np.zeros(array.shape, "V3"),
        ]
    unsealed(path, header, {**arrays, name: one_of(rng, others)})


def not_finite(path: Path, rng: Rng) -> None:
    header, arrays = read_arrays(path)
    floats = sorted(name for name, a in arrays.items() if a.dtype.kind == "f" and a.size)
    name = one_of(rng, floats)
    array = arrays[name].copy()
    array.reshape(-1)[int(rng.integers(array.size))] = one_of(rng, [np.nan, np.inf])
    # As an older version would have written it.
    unsealed(path, {**header, "schema": 3}, {**arrays, name: array})


def other_value(path: Path, rng: Rng) -> None:
    header, arrays = read_arrays(path)
    name = one_of(rng, sorted(name for name, array in arrays.items() if array.size))
    array = arrays[name].copy()
    flat = array.reshape(-1)
    place = int(rng.integers(flat.size))
    flat[place] = flat[place] + 1 if flat.dtype.kind != "b" else not flat[place]
    unsealed(path, header, {**arrays, name: array})


def other_names(path: Path, rng: Rng) -> None:
    header, arrays = read_arrays(path)
    first, second = one_of(rng, sorted(arrays)), one_of(rng, sorted(arrays))
    arrays = dict(arrays)
    kind = int(rng.integers(3))
    if kind == 0:
        del arrays[first]
    elif kind == 1:
        arrays[one_of(rng, ["policy", "../x", "policy/\x1b[31m", f"{first}/x"])] = arrays.pop(first)
    else:
        del arrays[first]
        arrays[f"{first}x"] = arrays.get(second, np.zeros(2))
    sealed(path, header, arrays)


WRONG = (
    None,
    "x",
    [],
    {},
    True,
    -1.5,
    10**400,
    [[]],
    {"a": 1},
    ["\x1b[2J"],
    "\ud800",
    float("nan"),
)


def header_values(path: Path, rng: Rng) -> None:
    header, arrays = read_arrays(path)
    places = [(header, name) for name in header if name != "digest"]
    for name in ("policy", "gate", "sources", "external"):
        places += [(header[name], inner) for inner in header.get(name, ())]
    for name in ("support", "threshold"):
        places += [(header["gate"][name], inner) for inner in header["gate"][name]]
    where, name = one_of(rng, places)
    wrong = one_of(rng, [value for value in WRONG if type(value) is not type(where[name])])
    if wrong is None and rng.random() < 0.5:
        del where[name]
    else:
        where[name] = wrong
    sealed(path, header, arrays)


def hyperparameters(path: Path, rng: Rng) -> None:
    header, arrays = read_arrays(path)
    hyper = header["policy"]["hyper"]
    wild = (-1, 10**9, 10**18, 1e308, [10**9] * 3, [], [1] * 999, [[[[[[[[1]]]]]]]], "x", None, {})
    name = one_of(rng, [*sorted(hyper), "another"])
    hyper[name] = one_of(rng, [value for value in wild if value != hyper.get(name)])
    sealed(path, header, arrays)


def header_text(path: Path, rng: Rng) -> None:
    header, arrays = read_arrays(path)
    text = json.dumps(header)
    texts = [
        "",
        "{",
        "7",
        "[" * 200_000,
        '{"a":' * 100_000,
        text[: int(rng.integers(len(text)))],
        text.replace('"round"', '"rounds"'),
        text.replace("sheath-checkpoint", "sheath-check\x1b[31mpoint"),
        "9" * 5000,
        "\x00" * 100,
    ]
    unsealed(path, one_of(rng, texts), arrays)


def entry(header: bytes, content: bytes = b"") -> bytes:
    """An .npy of a header as it stands, whatever it says."""
    padded = header.ljust(118, b" ") + b"\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(padded)) + padded + content


def bombs(path: Path, rng: Rng) -> None:
    """Little on the disk, and much in memory, by what the file says of itself."""
    header, arrays = read_arrays(path)
    shapes = (
        b"{'descr': '<f4', 'fortran_order': False, 'shape': (1000000000000,), }",
        b"{'descr': '<f4', 'fortran_order': False, 'shape': (-1,), }",
        b"{'descr': '<f4', 'fortran_order': False, 'shape': (4611686018427387904, 4), }",
        b"{'descr': '<U1000000000', 'fortran_order': False, 'shape': (1,), }",
        b"{'descr': '|O', 'fortran_order': False, 'shape': (1,), }",
        b"{'descr': '<f4', 'fortran_order': False, 'shape': 9, }",
        b"{" * 110,
    )
    kind = int(rng.integers(4))
    name = one_of(rng, sorted(arrays))
    others = {key: array for key, array in arrays.items() if key != name}
    unsealed(path, header, others)
    with zipfile.ZipFile(path, "a", zipfile.ZIP_DEFLATED, allowZip64=True) as archive:
        if kind == 0:
            archive.writestr(f"{name}.npy", entry(one_of(rng, shapes), bytes(64)))
        elif kind == 1:
            with archive.open(f"{name}.npy", "w", force_zip64=True) as file:
                for _ in range(300):
                    file.write(bytes(1 << 20))
        elif kind == 2:
            for number in range(21_000):
                archive.writestr(f"policy/{number}.npy", b"")
        else:
            buffer = io.BytesIO()
            np.save(buffer, np.zeros(3))
            with warnings.catch_warnings(action="ignore"):
                archive.writestr(f"{sorted(others)[0]}.npy", buffer.getvalue())


def declared(path: Path, rng: Rng) -> None:
    """The zip's directory tells of other sizes, methods or flags."""
    content = bytearray(path.read_bytes())
    entries, at = [], content.find(b"PK\x01\x02")
    while at >= 0:
        entries.append(at)
        at = content.find(b"PK\x01\x02", at + 1)
    at = one_of(rng, entries)
    place, wrong = one_of(
        rng,
        [
            (24, struct.pack("<I", 0xFFFFFFF0)),
            (20, struct.pack("<I", 0x7FFFFFFF)),
            (10, struct.pack("<H", int(rng.integers(20, 100)))),
            (8, struct.pack("<H", 1)),
            (42, struct.pack("<I", int(rng.integers(1 << 31)))),
        ],
    )
    content[at + place : at + place + len(wrong)] = wrong
    path.write_bytes(bytes(content))


WAYS: Mapping[str, Spoil] = {
    "cut short": cut,
    "bits flipped": flip_bits,
    "bytes overwritten": overwrite,
    "something else in its place": foreign,
    "an array of another shape": other_shape,
    "an array of another type": other_type,
    "a number that is none": not_finite,
    "a number that changed": other_value,
    "arrays missing or of other names": other_names,
    "values of the header": header_values,
    "hyperparameters": hyperparameters,
    "text of the header": header_text,
    "memory bombs": bombs,
    "the archive's own directory": declared,
}
