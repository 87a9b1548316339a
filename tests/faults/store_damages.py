"""Ways to harm a store of three sound episodes, drawn by a seed: wider than accidents are."""

import json
import os
import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from sheath_manip.dataset.marker import MARKER
from sheath_manip.dataset.zarr_files import array_files
from tests.dataset.damages import array_folders, files, one_of
from tests.dataset.seals import reseal
from tests.faults.hostile_stores import (
    bomb,
    false_frame,
    hostile_field,
    hostile_json,
    hostile_marks,
    linked,
    other_metadata,
    pipe,
    true_bomb,
)
from tests.faults.store_parts import Damage, Rng, chunk, episode, episodes, metadata, values_of


def flip(file: Path, rng: Rng, bits: int = 1) -> None:
    content = bytearray(file.read_bytes())
    for _ in range(bits):
        content[int(rng.integers(len(content)))] ^= 1 << int(rng.integers(8))
    file.write_bytes(content)


def rewritten(folder: Path, values: np.ndarray) -> None:
    """The array in good order, with other values."""
    shape = json.loads((folder / "zarr.json").read_text())["chunk_grid"]["configuration"]
    shutil.rmtree(folder)
    folder.mkdir()
    for name, content in array_files(values, tuple(shape["chunk_shape"])):
        (folder / name).write_bytes(content)


def array_with_values(store: Path, rng: Rng) -> Path:
    return one_of(rng, [f for f in array_folders(episode(store, rng)) if values_of(f).size])


def overwritten(store: Path, rng: Rng) -> None:
    file = one_of(rng, files(store))
    content = bytearray(file.read_bytes())
    start, noise = int(rng.integers(len(content))), rng.bytes(int(rng.integers(1, 40)))
    content[start : start + len(noise)] = noise
    file.write_bytes(content)


def swapped(store: Path, rng: Rng) -> None:
    """A chunk, an array or a film's two halves change places with those of another episode."""
    one, other = rng.permutation(np.array(episodes(store), object))[:2]
    film = one / "images/front"
    pairs = [(film / "c.0.0.0.0", film / "c.1.0.0.0")]
    for folder in array_folders(one):
        path = folder.relative_to(one)
        pairs.append((folder, other / path))
        pairs += [(f, other / f.relative_to(one)) for f in folder.iterdir() if f.name[0] == "c"]
    first, second = one_of(rng, pairs)
    aside = store / ".tmp-aside"
    first.rename(aside)
    second.rename(first)
    aside.rename(second)


def truncated(store: Path, rng: Rng) -> None:
    file = one_of(rng, files(store))
    os.truncate(file, int(rng.integers(file.stat().st_size)))


def grown(store: Path, rng: Rng) -> None:
    file = one_of(rng, files(store))
    content = file.read_bytes()
    # What follows is noise, the same again, a frame that decoders skip, or a hole of a terabyte.
    skipped = bytes.fromhex("502a4d1804000000") + b"mine"
    more = one_of(rng, [rng.bytes(9), content, skipped, b"\n \n", None])
    if more is None:
        os.truncate(file, 1 << 40)
    else:
        file.write_bytes(content + more)


def other_values(store: Path, rng: Rng) -> None:
    """Right checksums, right shapes, one value that is another."""
    folder = array_with_values(store, rng)
    values = values_of(folder).copy()
    flat = values.reshape(-1).view(np.uint8)
    flat[int(rng.integers(flat.size)) // values.itemsize * values.itemsize] ^= 1
    rewritten(folder, values)


def changed_field(store: Path, rng: Rng) -> None:
    """A value that is as good as the one that was recorded: only the digest tells."""
    file = episode(store, rng) / "zarr.json"
    told = json.loads(file.read_text())
    changes: Mapping[str, Any] = {
        "outcome": "failure",
        "control_rate_hz": 20.0,
        "metrics": {"distance_m": 0.25},
        "terminated": True,
        "variant": "other",
        "checkpoint": "abc",
        "versions": {},
        "recorded_utc": "2020-01-01T00:00:00+00:00",
    }
    key = one_of(rng, sorted(changes))
    told["attributes"][key] = changes[key]
    file.write_text(json.dumps(told))


def missing(store: Path, rng: Rng) -> None:
    one = episode(store, rng)
    places = [*files(one), *array_folders(one), one / "images", one / "final", store / MARKER]
    place = one_of(rng, places)
    shutil.rmtree(place) if place.is_dir() else place.unlink()


def foreign(store: Path, rng: Rng) -> None:
    one = episode(store, rng)
    names = ["notes.txt", "images/front/c.7.0.0.0", "data/c.0", ".zattrs", "\x1b[31mred", "a\nb"]
    places = [*(one / name for name in names), *(store / name for name in names[4:])]
    place = one_of(rng, [*places, one / "/".join("d" * 40), store / "learning-s0"])
    place.parent.mkdir(parents=True, exist_ok=True)
    place.write_text("mine")


def moved(store: Path, rng: Rng) -> None:
    """An episode lies under a name that is not its own, or twice."""
    one, other = rng.permutation(np.array(episodes(store), object))[:2]
    new = store / one.name.replace("-i00", "-i07")
    if rng.random() < 0.5:
        shutil.rmtree(other)
        new = other
    shutil.copytree(one, new) if rng.random() < 0.5 else one.rename(new)


DAMAGES: Mapping[str, Damage] = {
    "a bit of a chunk": lambda store, rng: flip(chunk(store, rng), rng),
    "a bit of JSON": lambda store, rng: flip(metadata(store, rng), rng),
    "many bits of a file": lambda store, rng: flip(one_of(rng, files(store)), rng, 20),
    "noise in a file": overwritten,
    "chunks and arrays change places": swapped,
    "a file cut short": truncated,
    "a file grown": grown,
    "other values, right checksums": other_values,
    "other types, shapes and codecs": other_metadata,
    "a link": linked,
    "a fifo or a socket": pipe,
    "hostile JSON": hostile_json,
    "hostile values in a header": hostile_field,
    "hostile values, digest made anew": lambda store, rng: hostile_field(store, rng, reseal),
    "a header's value is another": changed_field,
    "sizes beyond any memory": bomb,
    "a bomb that fits its header": true_bomb,
    "a frame of a false size": false_frame,
    "pieces missing": missing,
    "hostile marks": hostile_marks,
    "foreign entries": foreign,
    "episodes under other names": moved,
}
