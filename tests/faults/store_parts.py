"""Places in a store of three episodes, drawn by chance."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import zarr

from tests.dataset.damages import files, one_of

Rng = np.random.Generator
Damage = Callable[[Path, Rng], None]
"""Harms the store in a directory."""


def episodes(store: Path) -> list[Path]:
    return sorted(path for path in store.iterdir() if path.is_dir() and path.name[0] != ".")


def episode(store: Path, rng: Rng) -> Path:
    return one_of(rng, episodes(store))


def chunk(store: Path, rng: Rng) -> Path:
    return one_of(rng, [f for f in files(episode(store, rng)) if f.name != "zarr.json"])


def metadata(store: Path, rng: Rng) -> Path:
    every = [f for f in files(store) if f.name == "zarr.json" or f.parent == store]
    return one_of(rng, every)


def values_of(folder: Path) -> np.ndarray:
    return np.asarray(zarr.open_array(folder, mode="r")[...])
