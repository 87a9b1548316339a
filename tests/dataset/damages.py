"""The ways to damage a stored episode, each with the faults of which one must be named."""

import json
import shutil
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import zarr

from sheath_manip.dataset.faults import FaultKind
from sheath_manip.dataset.zarr_files import array_files
from tests.dataset.seals import unseal

LENGTH = 5
"""steps of the episode that is damaged"""
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
    for name, content in array_files(values, tuple(max(1, n) for n in values.shape)):
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
        unseal(episode)

    return damage


def header(**options: Any) -> Damage:
    """An attribute of that name with one of the values; `...` takes it away."""

    def damage(episode: Path, rng: Rng) -> None:
        key = one_of(rng, sorted(options))
        value = one_of(rng, options[key])
        unseal(episode, lambda attributes: attributes.pop(key))
        if value is not ...:
            unseal(episode, lambda attributes: attributes.update({key: value}))

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
    "folder for a file": (file_to_folder, {K.ODD_FILE}),
    "another length": (rewrite(other_length), {K.MISMATCH}),
    "another type": (rewrite(other_type), {K.MISMATCH}),
    "length in the header": (header(length=[4, 6, 10**5]), {K.MISMATCH, K.MISSING}),
    "no length": (header(length=[0, -3, 10**18, 10**8, *WRONG]), {K.UNREADABLE}),
    "NaN executed": (spoil_value("executed", np.nan), {K.NOT_FINITE}),
    "infinity labelled": (spoil_value("labelled", -np.inf), {K.NOT_FINITE}),
    "unknown code": (spoil_value("reason", 200), {K.MISMATCH}),
    "another count": (header(expert_steps=[5], queries=[5]), {K.MISMATCH}),
    "no count": (header(expert_steps=[-1, 77], queries=[99, 1.5]), {K.UNREADABLE}),
    "another schema": (header(schema=[0, 3, 99, "1", *WRONG]), {K.SCHEMA}),
    "another format": (header(format=["lerobot", *WRONG]), {K.FOREIGN}),
    "foreign attributes": (foreign_attributes, {K.FOREIGN}),
    "foreign JSON": (foreign_json, {K.UNREADABLE, K.FOREIGN, K.MISMATCH, K.ODD_FILE}),
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
        header(
            cameras=[{"../x": [4, 4]}, {"front": 4}, [], None, {"front": [1 << 16, 1 << 16]}],
            action_size=["x", None, ..., -2, 1e3, 10**9],
        ),
        {K.UNREADABLE},
    ),
    "another shape": (
        header(action_size=[0, 3], state_size=[1], cameras=[{"front": [9, 9]}]),
        {K.MISMATCH},
    ),
    "metadata of an array": (array_metadata, {K.UNREADABLE, K.MISMATCH, K.MISSING}),
    "another name": (rename, {K.MISMATCH}),
}
