"""Stores as somebody would write them who wants to harm who reads them."""

import json
import os
import shutil
import socket
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numcodecs.zstd import Zstd

from sheath_manip.dataset.digests import DIGEST
from sheath_manip.dataset.layout import ArraySpec
from sheath_manip.dataset.marker import MARKER
from sheath_manip.dataset.zarr_files import metadata_file
from tests.dataset.damages import array_folders, files, one_of
from tests.dataset.seals import reseal, unseal
from tests.faults.store_parts import Rng, chunk, episode, metadata, values_of

HOSTILE: tuple[Any, ...] = (
    *(None, True, -1, 0, 0.5, 10**9, 10**18, 10**400, 1e308, "", "x", "\x1b[2J", "NaN", "ä" * 5000),
    *([], {}, [[]], {"x": 1}, [0.5, 1], [10**9, 10**9]),
)
"""for a field of a header or of marks"""
CODECS = (
    *(
        "pickle",
        "vlen-utf8",
        "vlen-bytes",
        "numcodecs.pickle",
        "json2",
        "gzip",
        "blosc",
        "transpose",
    ),
    *("sharding_indexed", "crc32c", "numcodecs.lzma", "os.system"),
)
DTYPES = (
    "object",
    "string",
    "variable_length_utf8",
    "fixed_length_utf32",
    "complex64",
    "r8",
    "int8",
)


def other_metadata(store: Path, rng: Rng) -> None:
    file = one_of(rng, array_folders(episode(store, rng))) / "zarr.json"
    told = json.loads(file.read_text())
    codec = {"name": one_of(rng, CODECS), "configuration": {}}
    shapes = ([7, 7], [-1], "x", [10**15], [10**9, 10**9], [], None, [0.5])
    changes: list[Callable[[], Any]] = [
        lambda: told.update(codecs=[codec]),
        lambda: told["codecs"].insert(int(rng.integers(3)), codec),
        lambda: told.update(data_type=one_of(rng, DTYPES)),
        lambda: told.update(data_type={"name": one_of(rng, DTYPES), "configuration": {}}),
        lambda: told.update(shape=one_of(rng, shapes)),
        lambda: told["chunk_grid"]["configuration"].update(chunk_shape=one_of(rng, shapes)),
        lambda: told.update(fill_value=one_of(rng, [1, "NaN", {}])),
        lambda: told.update(zarr_format=2),
        lambda: told.update(storage_transformers=[codec]),
        lambda: told["codecs"][0].update(configuration={"endian": "big"}),
        lambda: told.update(attributes={"x": 1}),
        lambda: told.pop(one_of(rng, sorted(told))),
    ]
    one_of(rng, changes)()
    file.write_text(json.dumps(told))


def linked(store: Path, rng: Rng) -> None:
    """A link to what another store has at that place, to nothing, to itself, or to a device."""
    outside = store.parent / "outside"
    one = episode(store, rng)
    places = [*files(one), *(f for f in one.rglob("*") if f.is_dir()), one, store / MARKER]
    place = one_of(rng, [*places, next(store.glob("*.marks.json"))])
    inside = outside / place.relative_to(store)
    target = one_of(rng, [inside, inside, Path("/nowhere"), place, Path("/dev/zero")])
    shutil.rmtree(place) if place.is_dir() else place.unlink()
    place.symlink_to(target)


def pipe(store: Path, rng: Rng) -> None:
    one = episode(store, rng)
    where = [*files(one), store / MARKER, next(store.glob("*.marks.json"))]
    new = [one / "more", one / "images/front/c.9.0.0.0", store / "new", store / ".tmp-x"]
    place = one_of(rng, [*where, *new, one])
    shutil.rmtree(place) if place.is_dir() else place.unlink(missing_ok=True)
    if rng.random() < 0.5:
        os.mkfifo(place)
        return
    # A socket's path has at most some hundred characters.
    there = Path.cwd()
    os.chdir(place.parent)
    try:
        with socket.socket(socket.AF_UNIX) as made:
            made.bind(place.name)
    finally:
        os.chdir(there)


def hostile_json(store: Path, rng: Rng) -> None:
    texts = (
        *("[" * 60_000, '{"a":' * 60_000, "null", "[]", "1e999", '{"a": "\\ud800"}', "\ufeff{}"),
        *("", "{}", "9" * 5_000, "NaN", '{"a": 1, "a": 2}', '"' + "x" * 5_000_000 + '"', "\x00"),
        "[" * 15 + "]" * 15,
    )
    metadata(store, rng).write_text(one_of(rng, texts))


def hostile_field(store: Path, rng: Rng, change: Any = None) -> None:
    """A field of a header is another, is gone, or is one more; sometimes as before digests."""

    def spoil(attributes: dict[str, Any]) -> None:
        key = one_of(rng, sorted(attributes.keys() - {"format"}))
        inner = attributes[key]
        if isinstance(inner, dict) and inner and rng.random() < 0.5:
            inner[one_of(rng, sorted(inner))] = one_of(rng, HOSTILE)
        else:
            attributes[key] = one_of(rng, HOSTILE)
        if rng.random() < 0.2:
            attributes.pop(key)
        if rng.random() < 0.1:
            attributes["more"] = one_of(rng, HOSTILE)

    (change or unseal)(episode(store, rng), spoil)


def bomb(store: Path, rng: Rng) -> None:
    """Headers of sizes that nobody has memory for, all of it told as it should be."""
    one = episode(store, rng)
    sizes: dict[str, Any] = one_of(
        rng,
        [
            {"length": 10**7},
            {"length": 10**8, "cameras": {"front": [60_000, 60_000]}},
            {"cameras": {"front": [1600, 1700]}},
            {"cameras": {f"c{i}": [1000, 1000] for i in range(256)}},
            {"state_size": 900_000},
            {"action_size": 10**7, "space": None},
            {"feature_size": 10**7, "space": None},
        ],
    )

    def swell(attributes: dict[str, Any]) -> None:
        attributes.update(sizes)

    (reseal if rng.random() < 0.5 else unseal)(one, swell)


def true_bomb(store: Path, rng: Rng) -> None:
    """A film of nothing but black of the size that its header tells: 400 MB out of 50 kB."""
    one = episode(store, rng)
    size = one_of(rng, [(300, 1400), (400, 1400), (500, 1400), (1400, 1400)])
    length = len(values_of(one / "reward"))
    spec = ArraySpec("images/front", (length, *size, 3), "uint8")
    final = ArraySpec("final/images/front", (*size, 3), "uint8")
    zstd = Zstd(level=1, checksum=True)
    for each in (spec, final):
        folder = one / each.path
        shutil.rmtree(folder)
        folder.mkdir()
        (folder / "zarr.json").write_bytes(metadata_file(each.shape, "uint8", each.chunks))
        black = zstd.encode(np.zeros(each.chunks, np.uint8))
        for start in range(0, each.shape[0] if each is spec else 1, each.chunks[0]):
            rest = ".0" * (len(each.shape) - 1)
            (folder / f"c.{start // each.chunks[0]}{rest}").write_bytes(black)

    def swell(attributes: dict[str, Any]) -> None:
        attributes["cameras"] = {"front": list(size)}

    reseal(one, swell)


def false_frame(store: Path, rng: Rng) -> None:
    """A chunk whose first bytes tell of another size than it has, or of none."""
    file = chunk(store, rng)
    content = file.read_bytes()
    told = one_of(rng, [b"\xff" * 8, bytes(8), (1 << 40).to_bytes(8, "little")])
    descriptor = one_of(rng, [0xE4, 0xC4, 0x04, 0xE7, 0x64])
    file.write_bytes(content[:4] + bytes([descriptor]) + told + content[9:])


def hostile_marks(store: Path, rng: Rng) -> None:
    file = next(store.glob("*.marks.json"))
    told = json.loads(file.read_text())
    if rng.random() < 0.8:
        del told[DIGEST]
    bad = ([[0.5, 1]], [[1, 0]], [[0, 10**18]], [[-1, 3]], [[0, 2], [1, 3]], [[3, 4], [0, 1]], [1])
    changes: list[Callable[[], Any]] = [
        lambda: told.update(bad=one_of(rng, bad)),
        lambda: told.update(bad=one_of(rng, HOSTILE)),
        lambda: told.update(outcome=one_of(rng, HOSTILE[1:])),
        lambda: told.update(schema=one_of(rng, HOSTILE)),
        lambda: told.update(more=1),
        lambda: told.pop(one_of(rng, sorted(told))),
    ]
    one_of(rng, changes)()
    file.write_text(json.dumps(told))
