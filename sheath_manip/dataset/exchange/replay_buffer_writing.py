"""Writing a ReplayBuffer; `replay_buffer` says what is where."""

import shutil
import zipfile
from collections import defaultdict
from collections.abc import Iterable
from pathlib import Path

import numpy as np
import zarr
from numcodecs import Zstd
from numpy.typing import NDArray

from sheath_manip.dataset.attributes import to_attributes
from sheath_manip.dataset.exchange.actions import REQUESTED, chosen, requested
from sheath_manip.dataset.exchange.sealing import digest_of
from sheath_manip.dataset.exchange.selection import ActionChoice
from sheath_manip.dataset.exchange.uniform import uniform
from sheath_manip.dataset.header import Header
from sheath_manip.dataset.layout import FRAMES_PER_CHUNK, LIMITED, SIGNALS, layout
from sheath_manip.dataset.recorded import Recorded
from sheath_manip.types import Outcome

ATTRIBUTE = "sheath"
DIGESTS = "digests"
_ZIP_DATE = (1980, 1, 1, 0, 0, 0)
"""The earliest that a zip can tell: the same episodes shall make the same file."""


def write(target: Path, episodes: Iterable[Recorded], action: ActionChoice) -> None:
    """Write `episodes` to `target`: a zip where its name ends so, else a directory."""
    folder = target.with_name(f"{target.name}.d") if target.suffix == ".zip" else target
    _write_folder(folder, episodes, action)
    if folder != target:
        _pack(folder, target)
        shutil.rmtree(folder)


def _write_folder(folder: Path, episodes: Iterable[Recorded], action: ActionChoice) -> None:
    root = zarr.create_group(folder, zarr_format=2)
    data, meta = (_Columns(root.create_group(name)) for name in ("data", "meta"))
    headers: list[Header] = []
    digests: list[str] = []
    own: dict[str, list[NDArray | None]] = {LIMITED: [], SIGNALS: []}
    ends, finals = [0], defaultdict[str, list[NDArray]](list)
    for recorded in uniform(episodes):
        header, arrays = recorded.header, recorded.arrays
        for spec in layout(header):
            if spec.path.startswith("final/"):
                finals[flat(spec.path)].append(arrays[spec.path])
            elif spec.path not in own:
                data.append(flat(spec.path), arrays[spec.path])
        data.append("action", chosen(recorded, action))
        data.append(REQUESTED, requested(recorded))
        for path, values in own.items():
            values.append(arrays.get(path))
        finals["terminated"].append(np.array(header.terminated))
        finals["truncated"].append(np.array(header.truncated))
        finals["success"].append(np.array(header.outcome is Outcome.SUCCESS))
        ends.append(ends[-1] + header.length)
        headers.append(header)
        digests.append(digest_of(recorded))
    meta.append("episode_ends", np.array(ends[1:], np.int64))
    for name, values in finals.items():
        meta.append(name, np.stack(values))
    named = {
        LIMITED: [header.limits for header in headers],
        SIGNALS: [header.signals for header in headers],
    }
    every = {
        path: sorted({name for names in each for name in names}) for path, each in named.items()
    }
    for path, names in every.items():
        if names:
            data.append(path, _common(named[path], own[path], names, headers))
    root.attrs[ATTRIBUTE] = {
        "action": action.value,
        "limits": every[LIMITED],
        "signals": every[SIGNALS],
        "episodes": [to_attributes(header) for header in headers],
        DIGESTS: digests,
    }


def _common(
    named: list[tuple[str, ...]],
    own: list[NDArray | None],
    every: list[str],
    headers: list[Header],
) -> NDArray[np.float64]:
    """(N, l, ...): each episode names only the columns that it has."""
    width = next(values.shape[2:] for values in own if values is not None)
    parts = []
    for names, values, header in zip(named, own, headers, strict=True):
        part = np.full((header.length, len(every), *width), np.nan)
        if values is not None:
            part[:, [every.index(name) for name in names]] = values
        parts.append(part)
    return np.concatenate(parts)


def flat(path: str) -> str:
    """The name of an array of `layout` in a flat group."""
    return path.replace("images/", "image_").replace("/", "_")


class _Columns:
    """A flat group whose arrays grow by rows."""

    def __init__(self, group: zarr.Group) -> None:
        self.group = group
        # An array that is opened again has forgotten that it is to write chunks of zeros too.
        self._arrays: dict[str, zarr.Array] = {}

    def append(self, name: str, values: NDArray) -> None:
        if name in self._arrays:
            self._arrays[name].append(values)
            return
        self._arrays[name] = self.group.create_array(
            name,
            data=np.ascontiguousarray(values),
            chunks=(FRAMES_PER_CHUNK, *(max(1, size) for size in values.shape[1:])),
            compressors=Zstd(level=1),
            config={"write_empty_chunks": True},
        )


def _pack(folder: Path, target: Path) -> None:
    # The chunks are compressed already.
    with zipfile.ZipFile(target, "w", zipfile.ZIP_STORED) as archive:
        for file in sorted(folder.rglob("*")):
            if file.is_file():
                name = file.relative_to(folder).as_posix()
                archive.writestr(zipfile.ZipInfo(name, _ZIP_DATE), file.read_bytes())
