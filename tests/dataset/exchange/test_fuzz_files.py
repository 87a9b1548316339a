"""Damaged exports: what was meant comes back whole, or one line says why it does not."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import zarr

from sheath_manip.dataset.exchange.exporting import export
from sheath_manip.dataset.exchange.formats import open_file
from sheath_manip.dataset.exchange.importing import import_episodes
from sheath_manip.dataset.exchange.selection import Selection
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import SheathError
from tests.dataset.generated import of_task
from tools.identical import identical

Rng = np.random.Generator
ATTRIBUTES = (7, [], {}, {"episodes": 3}, {"episodes": [], "limits": []}, {"episodes": [1, 2]})
HEADERS = (
    {"schema": 2},
    {"length": 1},
    {"format": "x"},
    {"actors": []},
    {"cameras": {"moon": [1, 1]}},
    {"limits": ["moon"]},
    {"expert_steps": -1},
    {"control_rate_hz": 0},
)


def one_of(rng: Rng, options: Any) -> Any:
    return options[int(rng.integers(len(options)))]


def spoil_file(path: Path, rng: Rng) -> None:
    """A file of the export is cut, gone or noise."""
    file = (
        path if path.is_file() else one_of(rng, sorted(f for f in path.rglob("*") if f.is_file()))
    )
    content = file.read_bytes()
    content = one_of(rng, [content[: int(rng.integers(len(content)))], rng.bytes(50), None])
    file.unlink() if content is None else file.write_bytes(content)


def spoil_attribute(path: Path, rng: Rng) -> None:
    file = path / ".zattrs"
    file.write_text(json.dumps({"sheath": one_of(rng, ATTRIBUTES)}))


def spoil_header(path: Path, rng: Rng) -> None:
    file, change = path / ".zattrs", one_of(rng, HEADERS)
    attributes = json.loads(file.read_text())
    attributes["sheath"]["episodes"][0] |= change
    file.write_text(json.dumps(attributes))


def spoil_limits(path: Path, rng: Rng) -> None:
    root = zarr.open_group(path, mode="r+")
    array = root["data/limited"]
    assert isinstance(array, zarr.Array)
    values = np.asarray(array[...])
    values = one_of(rng, [values[:, :1], values[:, 0], values[..., None], values[:1]])
    root.create_array("data/limited", data=values, overwrite=True)


def spoil_ends(path: Path, rng: Rng) -> None:
    root = zarr.open_group(path, mode="r+")
    ends = one_of(rng, [np.zeros(2, int), np.array([9, 4]), np.ones((2, 2)), np.array([10**9])])
    root.create_array("meta/episode_ends", data=ends, overwrite=True)


def spoil_dataset(path: Path, rng: Rng) -> None:
    """An array is gone or another."""
    with h5py.File(path, "r+") as file:
        demo: Any = file["data/demo_0"]
        names: list[str] = []
        demo.visit(names.append)
        name = one_of(rng, [name for name in names if isinstance(demo[name], h5py.Dataset)])
        values = demo[name][()]
        del demo[name]
        other = one_of(rng, [None, np.atleast_1d(values)[:0], values.astype(complex), b"text"])
        if other is not None:
            demo[name] = other


def spoil_demo(path: Path, rng: Rng) -> None:
    with h5py.File(path, "r+") as file:
        demo: Any = file["data/demo_0"]
        header = json.loads(demo.attrs["sheath"])
        texts = ["", "{", "7", "null", *(json.dumps(header | change) for change in HEADERS)]
        demo.attrs["sheath"] = one_of(rng, texts)


CASES: list[tuple[str, str, Callable[[Path, Rng], None]]] = [
    ("replay-buffer", "x.zarr", spoil_file),
    ("replay-buffer", "x.zarr", spoil_attribute),
    ("replay-buffer", "x.zarr", spoil_header),
    ("replay-buffer", "x.zarr", spoil_limits),
    ("replay-buffer", "x.zarr", spoil_ends),
    ("replay-buffer", "x.zarr.zip", spoil_file),
    ("robomimic", "x.hdf5", spoil_file),
    ("robomimic", "x.hdf5", spoil_dataset),
    ("robomimic", "x.hdf5", spoil_demo),
]


@pytest.fixture(scope="module")
def exported(specs, tmp_path_factory) -> Path:
    """Two episodes in a `store`, and every format of them."""
    folder = tmp_path_factory.mktemp("exported")
    store = EpisodeStore.create(folder / "store")
    for episode in of_task(specs["corridor"], seed=2, longest=6):
        store.append(episode)
    for form, target in {(form, target) for form, target, _ in CASES}:
        export(store, folder / target, form, Selection())
    return folder


@pytest.mark.parametrize("number", range(4 * len(CASES)))
def test_a_damaged_export(exported: Path, tmp_path: Path, number: int) -> None:
    form, target, damage = CASES[number % len(CASES)]
    copy = shutil.copytree if (exported / target).is_dir() else shutil.copy
    path = Path(copy(exported / target, tmp_path / target))
    damage(path, np.random.default_rng(number))
    sound, back = EpisodeStore(exported / "store"), EpisodeStore.create(tmp_path / "back")
    said = "-"
    try:
        import_episodes(open_file(form, path), back, None)
    except SheathError as error:
        said = str(error)
    assert len(said.splitlines()) == 1
    # Whatever came in is as it was.
    for name in back.names():
        assert identical(back.read(name), sound.read(name))
