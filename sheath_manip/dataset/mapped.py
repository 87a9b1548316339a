"""Labelled states for training, mapped from files that are written once per set of episodes.

A zarr chunk holds 64 frames, so that drawing frames at random from it decompresses nearly all of
them; a plain file on the disk gives each at once, and its pages are shared by all processes.
"""

import hashlib
import shutil
import uuid
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.lib.format import open_memmap
from numpy.typing import NDArray

from sheath_manip.dataset.attributes import GROUP_FILE
from sheath_manip.dataset.durable import publish
from sheath_manip.dataset.exchange.uniform import uniform
from sheath_manip.dataset.layout import has_label, layout
from sheath_manip.dataset.marks import marks_text
from sheath_manip.dataset.naming import LEFTOVER_PREFIX
from sheath_manip.dataset.reader import EpisodeReader
from sheath_manip.dataset.recorded import Recorded
from sheath_manip.exceptions import ParameterError, StoreError
from sheath_manip.types.columns import ACTORS
from sheath_manip.types.samples import Samples

SCHEMA = 2
"""Raise it whenever the files of an older one would be misread."""
_IMAGE_PREFIX = "image-"


def mapped_samples(reader: EpisodeReader, names: Sequence[str], folder: Path) -> Samples:
    """Return all labelled states of the named episodes, as `samples_from`, in files under `folder`.

    The files are written at the first call for these very episodes and serve all later ones; what
    is changed in the arrays stays in memory. Raises ParameterError where there is no labelled
    state, and StoreError where an episode is damaged or the files cannot be written.
    """
    digest = hashlib.sha256(f"samples {SCHEMA}\n".encode())
    for name in names:
        # A header tells the moment of recording, so an episode recorded anew is another.
        digest.update(f"{name}\n".encode() + reader.content(name, GROUP_FILE))
        digest.update(marks_text(reader.marks(name)).encode())
    directory = folder / f"samples-{digest.hexdigest()[:32]}"
    if not directory.exists():
        _build(reader, names, directory)
    try:
        arrays = {file.stem: _mapped(file) for file in sorted(directory.glob("*.npy"))}
        return Samples(
            images={
                name.removeprefix(_IMAGE_PREFIX): array
                for name, array in arrays.items()
                if name.startswith(_IMAGE_PREFIX)
            },
            features=arrays["features"],
            labels=arrays["labels"],
            episodes=arrays["episodes"],
            steps=arrays["steps"],
            actors=arrays["actors"],
        )
    except (OSError, ValueError, KeyError) as error:
        raise StoreError(
            f"{directory} does not decode ({error}); delete it, it is made anew"
        ) from error


def mapped_once(reader: EpisodeReader, names: Sequence[str], beside: Path) -> Samples:
    """Return `mapped_samples` whose files lie beside the path `beside`, and go with the process.

    Raises as that.
    """
    try:
        beside.parent.mkdir(parents=True, exist_ok=True)
        # A mapped file stays where it is until nothing refers to it, also without its name.
        with TemporaryDirectory(prefix=LEFTOVER_PREFIX, dir=beside.parent) as folder:
            return mapped_samples(reader, names, Path(folder))
    except OSError as error:
        raise StoreError(f"cannot keep the training states in {beside.parent} ({error})") from error


def _build(reader: EpisodeReader, names: Sequence[str], directory: Path) -> None:
    """Write the files aside, then give their directory its name."""
    count = sum(int(labelled_steps(reader, name).sum()) for name in names)
    if not count:
        raise ParameterError(
            "no labelled state to train on; record episodes whose gate asks for labels"
        )
    aside = directory.with_name(f"{LEFTOVER_PREFIX}{uuid.uuid4().hex}")
    try:
        aside.mkdir(parents=True)
        files, start = dict[str, NDArray](), 0
        for number, recorded in enumerate(uniform(map(reader.recorded, names))):
            rows = _rows(recorded, labelled_steps(reader, names[number]), number)
            stop = start + len(rows["episodes"])
            for name, values in rows.items():
                if name not in files:
                    shape = (count, *values.shape[1:])
                    files[name] = open_memmap(aside / f"{name}.npy", "w+", values.dtype, shape)
                files[name][start:stop] = values
            start = stop
        # Written out when nothing refers to them any more.
        files.clear()
        publish(aside, directory)
    except FileExistsError:
        # Another process was quicker, and its files are the same.
        pass
    except OSError as error:
        raise StoreError(f"cannot write {directory} ({error})") from error
    finally:
        shutil.rmtree(aside, ignore_errors=True)


def labelled_steps(reader: EpisodeReader, name: str) -> NDArray[np.bool_]:
    """(T,) which steps of the episode `name` are learned from."""
    specs = {spec.path: spec for spec in layout(reader.header(name))}
    arrays = {path: reader.array(name, specs[path]) for path in ("has_labelled", "query")}
    has = has_label(arrays)
    return has & ~reader.marks(name).is_bad(len(has))


def _rows(recorded: Recorded, has: NDArray[np.bool_], number: int) -> dict[str, NDArray]:
    """The states of one episode that have a label, by the name of their file."""
    arrays = recorded.arrays
    # What the codes stand for is told by each recording.
    places = np.array([ACTORS.index(actor) for actor in recorded.header.actors], np.uint8)
    return {
        **{
            f"{_IMAGE_PREFIX}{camera}": arrays[f"images/{camera}"][has]
            for camera in recorded.header.cameras
        },
        "features": arrays["features"][has],
        "labels": arrays["labelled"][has],
        "episodes": np.full(int(has.sum()), number, np.int64),
        "steps": np.flatnonzero(has).astype(np.int32),
        "actors": places[arrays["actor"][has]],
    }


def _mapped(file: Path) -> NDArray:
    # Copy on write: torch warns of arrays that cannot be written to. As a plain array, since
    # numpy's memmap class costs time at every index.
    return np.asarray(np.load(file, mmap_mode="c", allow_pickle=False))
