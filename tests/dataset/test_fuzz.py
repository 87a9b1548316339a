"""A hundred damaged stores: `check` names the fault, and no reader crashes or is taken in."""

import shutil
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
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
from sheath_manip.exceptions import SheathError, StoreError
from sheath_manip.seeding import generator
from sheath_manip.types import Limited
from sheath_manip.types.samples import samples_from
from tests.dataset.damages import DAMAGES, LENGTH
from tests.dataset.folders import repacked, unpacked
from tools.identical import identical
from tools.synthetic import synthetic_episode, synthetic_info

STORES = 100


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
    rng, name = np.random.default_rng(number), sound.names()[0]
    inside = unpacked(store, name)
    damage(inside, rng)
    # What was recorded before lies in folders, where anything may be; an archive has plain files.
    folders = [path for path in (store.path / name).rglob("*") if path.is_dir()]
    lost = any(not any(folder.iterdir()) for folder in folders)
    if number % 2 and (store.path / name).exists() and not lost:
        repacked(store.path / name)
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
    some = others[number % 10], others[(number // 10 + number + 1) % 10]
    for reader in dict.fromkeys((*ALWAYS, *some)):
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
