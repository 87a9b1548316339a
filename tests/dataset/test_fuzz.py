"""A hundred damaged stores: `check` names the fault, and no reader crashes or is taken in."""

import json
import shutil
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import zarr
from rich.console import Console

from sheath_manip.dataset.card import card
from sheath_manip.dataset.check import check
from sheath_manip.dataset.exchange.exporting import export
from sheath_manip.dataset.exchange.selection import Selection
from sheath_manip.dataset.faults import FaultKind
from sheath_manip.dataset.locations import open_store
from sheath_manip.dataset.mapped import mapped_samples
from sheath_manip.dataset.marker import MARKER
from sheath_manip.dataset.merging import merge, split
from sheath_manip.dataset.show import print_show
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.dataset.table import print_check, print_list
from sheath_manip.dataset.zarr_files import array_files
from sheath_manip.exceptions import SheathError, StoreError
from sheath_manip.seeding import generator
from sheath_manip.types import Limited
from sheath_manip.types.samples import samples_from
from tools.identical import identical
from tools.synthetic import synthetic_episode, synthetic_info

STORES = 100
LENGTH = 5
Rng = np.random.Generator
Damage = Callable[[Path, Rng], None]
"""Spoils the episode in a directory."""


def one_of(rng: Rng, options: Any) -> Any:
    return options[int(rng.integers(len(options)))]


def files(episode: Path) -> list[Path]:
    return sorted(path for path in episode.rglob("*") if path.is_file())


def array_folders(episode: Path) -> list[Path]:
    metadata = (file for file in files(episode) if file.name == "zarr.json")
    return [f.parent for f in metadata if json.loads(f.read_text())["node_type"] == "array"]


def truncate(episode: Path, rng: Rng) -> None:
    file = one_of(rng, files(episode))
    file.write_bytes(file.read_bytes()[: int(rng.integers(file.stat().st_size))])


def truncate_chunk(episode: Path, rng: Rng) -> None:
    file = one_of(rng, [file for file in files(episode) if file.name != "zarr.json"])
    file.write_bytes(file.read_bytes()[: int(rng.integers(file.stat().st_size))])


def delete_file(episode: Path, rng: Rng) -> None:
    one_of(rng, files(episode)).unlink()


def delete_array(episode: Path, rng: Rng) -> None:
    shutil.rmtree(one_of(rng, array_folders(episode)))


def write_noise(episode: Path, rng: Rng) -> None:
    one_of(rng, files(episode)).write_bytes(rng.bytes(int(rng.integers(1, 200))))


def file_to_folder(episode: Path, rng: Rng) -> None:
    file = one_of(rng, files(episode))
    file.unlink()
    file.mkdir()


def write_array(folder: Path, values: np.ndarray) -> None:
    folder.mkdir()
    for name, content in array_files(values, tuple(max(1, n) for n in values.shape)).items():
        (folder / name).write_bytes(content)


def rewrite(change: Callable[[np.ndarray, Rng], np.ndarray]) -> Damage:
    """An array in good order that is another one."""

    def damage(episode: Path, rng: Rng) -> None:
        folder = one_of(rng, array_folders(episode))
        values = change(np.asarray(zarr.open_array(folder, mode="r")[...]), rng)
        shutil.rmtree(folder)
        write_array(folder, values)

    return damage


def other_length(values: np.ndarray, rng: Rng) -> np.ndarray:
    if not values.ndim:
        return np.repeat(values, 2)
    return np.resize(values, (one_of(rng, [0, 1, LENGTH - 1, LENGTH + 1]), *values.shape[1:], 1))


def other_type(values: np.ndarray, rng: Rng) -> np.ndarray:
    types = ["uint8", "bool", "int64", "float32", "float64"]
    return values.astype(one_of(rng, [t for t in types if t != values.dtype.name]))


def spoil_value(path: str, value: float) -> Damage:
    def damage(episode: Path, rng: Rng) -> None:
        values = np.array(zarr.open_array(episode / path, mode="r")[...])
        rows = np.arange(len(values))
        if path == "labelled":
            rows = np.flatnonzero(zarr.open_array(episode / "has_labelled", mode="r")[...])
        values[one_of(rng, rows)] = value
        shutil.rmtree(episode / path)
        write_array(episode / path, values)

    return damage


def header(**options: Any) -> Damage:
    """An attribute of that name with one of the values; `...` takes it away."""

    def damage(episode: Path, rng: Rng) -> None:
        group = json.loads((episode / "zarr.json").read_text())
        key = one_of(rng, sorted(options))
        value = one_of(rng, options[key])
        if value is ...:
            del group["attributes"][key]
        else:
            group["attributes"][key] = value
        (episode / "zarr.json").write_text(json.dumps(group))

    return damage


def foreign_attributes(episode: Path, rng: Rng) -> None:
    group = json.loads((episode / "zarr.json").read_text())
    others = [{}, [], None, 7, "x", {"format": "lerobot", "fps": 10}, {"sheath": {}}]
    group["attributes"] = one_of(rng, others)
    (episode / "zarr.json").write_text(json.dumps(group))


def foreign_json(episode: Path, rng: Rng) -> None:
    texts = ["[" * 100_000, "null", "[]", "1e999", '{"a": "\\ud800"}', "\ufeff{}", "{}", ""]
    one_of(rng, [f for f in files(episode) if f.name == "zarr.json"]).write_text(one_of(rng, texts))


def foreign_file(episode: Path, rng: Rng) -> None:
    name = one_of(rng, ["notes.txt", "images/rear/zarr.json", "data/c.0", ".zattrs"])
    (episode / name).parent.mkdir(parents=True, exist_ok=True)
    (episode / name).write_text("mine")


def array_metadata(episode: Path, rng: Rng) -> None:
    """What its reader wants to know of an array is another or gone."""
    file = one_of(rng, array_folders(episode)) / "zarr.json"
    metadata = json.loads(file.read_text())
    changes = [
        lambda: metadata.pop(one_of(rng, ["shape", "data_type", "chunk_grid", "codecs"])),
        lambda: metadata.update(data_type=one_of(rng, ["complex64", "moon", 3, "uint16"])),
        lambda: metadata.update(shape=one_of(rng, [[7, 7], [-1], "x", [10**15], None])),
        lambda: metadata.update(codecs=one_of(rng, [[], [{"name": "moon"}], None])),
        lambda: metadata.update(zarr_format=one_of(rng, [2, 4, None])),
        lambda: metadata.update(node_type=one_of(rng, ["group", "x"])),
    ]
    one_of(rng, changes)()
    file.write_text(json.dumps(metadata))


def rename(episode: Path, rng: Rng) -> None:
    del rng
    episode.rename(episode.with_name("learning-other-s0-r00-i000-seed9"))


K = FaultKind
WRONG = (None, "x", [], {}, -1e400, ...)
DAMAGES: Mapping[str, tuple[Damage, set[FaultKind]]] = {
    "truncated file": (truncate, {K.UNREADABLE}),
    "truncated chunk": (truncate_chunk, {K.UNREADABLE}),
    "missing file": (delete_file, {K.MISSING, K.FOREIGN}),
    "missing array": (delete_array, {K.MISSING}),
    "noise": (write_noise, {K.UNREADABLE}),
    "folder for a file": (file_to_folder, {K.MISSING, K.UNREADABLE, K.FOREIGN}),
    "another length": (rewrite(other_length), {K.MISMATCH}),
    "another type": (rewrite(other_type), {K.MISMATCH}),
    "length in the header": (header(length=[1, 4, 6, 10**18]), {K.MISMATCH, K.MISSING}),
    "no length": (header(length=[0, -3, *WRONG]), {K.UNREADABLE}),
    "NaN executed": (spoil_value("executed", np.nan), {K.NOT_FINITE}),
    "infinity labelled": (spoil_value("labelled", -np.inf), {K.NOT_FINITE}),
    "unknown code": (spoil_value("reason", 200), {K.MISMATCH}),
    "another count": (header(expert_steps=[-1, 77], queries=[99]), {K.MISMATCH}),
    "another schema": (header(schema=[0, 3, 99, "1", *WRONG]), {K.SCHEMA}),
    "another format": (header(format=["lerobot", *WRONG]), {K.FOREIGN}),
    "foreign attributes": (foreign_attributes, {K.FOREIGN}),
    "foreign JSON": (foreign_json, {K.UNREADABLE, K.FOREIGN, K.MISMATCH}),
    "foreign file": (foreign_file, {K.FOREIGN}),
    "a name for nothing": (
        header(outcome=["won", *WRONG], purpose=["fun", *WRONG], actors=[["me"], "x"]),
        {K.UNREADABLE},
    ),
    "no number": (
        header(control_rate_hz=[0, -1, *WRONG], seed=[*WRONG], metrics=[[], {"a": "x"}, None]),
        {K.UNREADABLE},
    ),
    "no shape": (
        header(cameras=[{"../x": [4, 4]}, {"front": 4}, [], None], action_size=["x", None, ...]),
        {K.UNREADABLE, K.FOREIGN, K.MISMATCH},
    ),
    "another shape": (
        header(action_size=[0, 3, -2], state_size=[1, -1], cameras=[{"front": [9, 9]}]),
        {K.MISMATCH},
    ),
    "metadata of an array": (array_metadata, {K.UNREADABLE, K.MISMATCH, K.MISSING}),
    "another name": (rename, {K.MISMATCH}),
}


@pytest.fixture(scope="module")
def sound(tmp_path_factory) -> EpisodeStore:
    """One episode with every kind of array."""
    store = EpisodeStore.create(tmp_path_factory.mktemp("sound") / "store")
    episode = synthetic_episode(synthetic_info(3, 0), LENGTH, pixels=4)
    limited = (Limited("joint velocity", 0.25),)
    first, *others = episode.steps
    labelled = replace(first, labelled=first.executed, limited=limited)
    store.append(replace(episode, steps=(labelled, *others)))
    return store


@dataclass(frozen=True)
class Damaged:
    """A copy of the sound store with one fault."""

    store: EpisodeStore
    kinds: set[FaultKind]
    """of which one must be named"""
    folder: Path
    """for what readers write"""


@pytest.fixture
def damaged(sound: EpisodeStore, tmp_path: Path, number: int) -> Damaged:
    store = EpisodeStore(shutil.copytree(sound.path, tmp_path / "store"))
    damage, kinds = list(DAMAGES.values())[number % len(DAMAGES)]
    damage(store.path / sound.names()[0], np.random.default_rng(number))
    return Damaged(store, kinds, tmp_path / "out")


def quiet() -> Console:
    return Console(file=StringIO(), width=200)


READERS: Mapping[str, Callable[[EpisodeStore, Path], Any]] = {
    "list": lambda store, _: print_list(str(store.path), quiet()),
    "show": lambda store, _: print_show(str(store.path), "0", quiet()),
    "card": lambda store, _: card(store, None, "MIT"),
    "summaries": lambda store, _: store.infos(),
    "samples": lambda store, _: samples_from(store.episodes()),
    "mapped": lambda store, out: mapped_samples(store, store.names(), out),
    "replay-buffer": lambda s, o: export(s, o / "x", "replay-buffer", Selection()),
    "robomimic": lambda s, o: export(s, o / "x", "robomimic", Selection()),
    "minari": lambda s, o: export(s, o / "x", "minari", Selection()),
    "split": lambda store, out: split(store, {"all": 1.0}, out, generator("split", 0)),
    "merge": lambda s, o: merge([s], EpisodeStore.create(o)) and EpisodeStore(o).read(s.names()[0]),
    "read": lambda store, _: store.read(store.names()[0]),
}
ALWAYS = ("list", "read")


@pytest.mark.parametrize("number", range(STORES))
def test_a_damaged_store(damaged: Damaged, sound: EpisodeStore, number: int) -> None:
    store = damaged.store
    (name,) = store.names()
    faults = check(store)
    assert {fault.name for fault in faults} == {name}
    assert {fault.kind for fault in faults} & damaged.kinds, faults
    assert all(fault.damaging and fault.text for fault in faults)
    assert "\n" not in "".join(fault.text for fault in faults)
    assert print_check(str(store.path), quiet()) == 1
    others = [reader for reader in READERS if reader not in ALWAYS]
    for reader in (*ALWAYS, others[number % 10], others[(number // 10 + number + 1) % 10]):
        said = ""
        try:
            READERS[reader](store, damaged.folder / reader)
        except SheathError as error:
            said = str(error)
        if said:
            assert name in said, reader
            assert "\n" not in said, reader
            left = [path.name for path in (damaged.folder / reader).rglob("*")]
            assert left in ([], [MARKER]), reader
    try:
        # Damage to what no array needs is no hindrance, and damage to an array always is.
        assert identical(store.read(name), sound.read(sound.names()[0]))
    except StoreError:
        assert any(fault.damaging for fault in faults)


@pytest.mark.parametrize(
    "content", [b"", b"{", b"[" * 100_000, b"\xff\xfe", b"null", b"{}", b'{"format": []}', None]
)
def test_a_damaged_marker(sound: EpisodeStore, tmp_path: Path, content: bytes | None) -> None:
    path = shutil.copytree(sound.path, tmp_path / "store")
    (path / MARKER).unlink()
    if content is not None:
        (path / MARKER).write_bytes(content)
    for opened in (EpisodeStore, EpisodeStore.create, open_store):
        with pytest.raises(StoreError, match=f"wanted an episode store at {path}") as caught:
            opened(str(path))
        assert "\n" not in str(caught.value)
