"""Labelled states that grow from round to round, their images in a file that is mapped.

Images are nearly all that states are. In memory they would be there twice whenever new ones come,
and all of them would have to fit; a mapped file is read a page at a time, and the system takes the
pages back where it needs the memory. The file has no name: it is gone with the process.
"""

import mmap
import tempfile
import weakref
from pathlib import Path
from typing import IO

import numpy as np
from numpy.typing import NDArray

from sheath_manip.dataset.disk import require_room
from sheath_manip.exceptions import StoreError
from sheath_manip.types.samples import Samples, joined


class AggregatedSamples:
    """Samples that are added to each other."""

    def __init__(self, folder: Path) -> None:
        """Keep the images on the disk of `folder`, which is made where there is none."""
        self._folder = folder
        self._films: dict[str, _Film] = {}
        self._rest: Samples | None = None
        """all of the states but their images"""

    def add(self, samples: Samples) -> "AggregatedSamples":
        """Take `samples` in at the end, their episodes numbered apart; raises StoreError."""
        bytes = sum(images.nbytes for images in samples.images.values())
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            require_room(self._folder, bytes)
            for camera, images in samples.images.items():
                if camera not in self._films:
                    self._films[camera] = _Film(self._folder, images)
                self._films[camera].append(images)
        except OSError as error:
            raise StoreError(
                f"cannot keep {bytes / 1e6:.0f} MB of training states in {self._folder} ({error})"
            ) from error
        rest = Samples(
            {}, samples.features, samples.labels, samples.episodes, samples.steps, samples.actors
        )
        self._rest = rest if self._rest is None else joined([self._rest, rest])
        return self

    def samples(self) -> Samples:
        """Return all of them; what is changed in the images stays in memory.

        At least one state must have been added.
        """
        rest = self._rest
        assert rest is not None
        images = {camera: film.mapped() for camera, film in self._films.items()}
        return Samples(images, rest.features, rest.labels, rest.episodes, rest.steps, rest.actors)


class _Film:
    """The images of one camera, end to end in a file without a name."""

    def __init__(self, folder: Path, first: NDArray) -> None:
        self._file: IO[bytes] = tempfile.TemporaryFile(dir=folder, buffering=0)  # noqa: SIM115
        weakref.finalize(self, self._file.close)
        self._shape, self._dtype, self._count = first.shape[1:], first.dtype, 0

    def append(self, images: NDArray) -> None:
        if (images.shape[1:], images.dtype) != (self._shape, self._dtype):
            raise StoreError(
                f"images of {images.dtype} {images.shape[1:]} come after some of {self._dtype} "
                f"{self._shape}; wanted all of one size"
            )
        for block in np.array_split(images, -(-max(images.nbytes, 1) // _BLOCK_BYTES)):
            left = np.ascontiguousarray(block).reshape(-1).view(np.uint8).data
            while left:
                left = left[self._file.write(left) :]
        self._count += len(images)

    def mapped(self) -> NDArray:
        shape = (self._count, *self._shape)
        if not np.prod(shape):
            return np.empty(shape, self._dtype)
        # Copy on write: torch warns of arrays that cannot be written to.
        mapped = mmap.mmap(self._file.fileno(), 0, access=mmap.ACCESS_COPY)
        return np.frombuffer(mapped, self._dtype).reshape(shape)


_BLOCK_BYTES = 64 << 20
"""so that images that are themselves mapped pass through little memory"""
