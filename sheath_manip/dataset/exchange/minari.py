"""Minari's data set of Farama: written by Minari itself, read from its HDF5 without it.

An episode has T+1 observations, a dictionary of `image_CAMERA` and `features`, and T actions (the
one that was chosen for export), rewards, terminations and truncations. `infos` holds every other
array of `layout` by its name there, with T rows, or T+1 of what is observed (`time_s`, `state`),
and `requested`, what the actor asked for. Each episode's metadata holds its header as `sheath` and
a digest of header and arrays as `sheath_digest`. Images are stored as they are, not as JPEG.
"""

import os
from collections.abc import Iterable
from pathlib import Path

from sheath_manip.dataset.exchange.formats import ForeignFile, Format
from sheath_manip.dataset.exchange.selection import ActionChoice
from sheath_manip.dataset.recorded import Recorded
from sheath_manip.exceptions import StoreError

ATTRIBUTE, DIGEST = "sheath", "sheath_digest"
METADATA = "metadata.json"


def located(path: Path) -> Path:
    """Return the folder of the data set at a path, or of that name where Minari keeps its own.

    Nothing is asked of the network. Raises StoreError where there is none.
    """
    kept = os.environ.get("MINARI_DATASETS_PATH") or Path.home() / ".minari" / "datasets"
    for folder in (path, Path(kept) / path):
        for data in (folder / "data", folder):
            if (data / METADATA).is_file():
                return data
    raise StoreError(
        f"wanted a Minari data set at {path} or in {kept}, found none; `minari download {path}` "
        "fetches one of Farama's"
    )


def _write(target: Path, episodes: Iterable[Recorded], action: ActionChoice) -> None:
    # Only this way wants Minari.
    from sheath_manip.dataset.exchange.minari_writing import write

    write(target, episodes, action)


def _open(path: Path) -> ForeignFile:
    from sheath_manip.dataset.exchange.minari_reading import MinariDataset

    return MinariDataset(path)


FORMAT = Format(_write, _open, located)
