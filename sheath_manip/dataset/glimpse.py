"""What cameras saw at a few steps of an episode, without decompressing the others."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from sheath_manip.dataset.faults import REMEDY, FaultError, FaultKind
from sheath_manip.dataset.layout import ArraySpec, layout
from sheath_manip.dataset.reader import EpisodeReader
from sheath_manip.dataset.zarr_files import chunk_key, decoded

Glimpse = dict[str, NDArray[np.uint8]]
"""(h, w, 3) RGB by camera"""


def glimpses(reader: EpisodeReader, name: str, steps: Iterable[int]) -> list[Glimpse]:
    """Return what each camera saw at `steps` of the episode `name`; each is empty without cameras.

    Each block is held against its own checksum, and not against the digest of all of them, for
    which all would have to be read. Raises StoreError, and FaultError for damage.
    """
    wanted = list(steps)
    films = [spec for spec in layout(reader.header(name)) if spec.is_film]
    found: list[Glimpse] = [{} for _ in wanted]
    with reader.opened(name) as content:
        for spec in films:
            size, blocks = spec.chunks[0], dict[int, NDArray]()
            chunk = ArraySpec(spec.path, spec.chunks, spec.dtype)
            most_bytes = chunk.bytes + chunk.bytes // 64 + 1024
            for place in sorted({step // size for step in wanted}):
                key = f"{spec.path}/{chunk_key((place, 0, 0, 0))}"
                try:
                    blocks[place] = decoded(content(key, most_bytes), spec.dtype, spec.chunks)
                except ValueError as error:
                    raise FaultError(
                        name,
                        FaultKind.UNREADABLE,
                        f"{spec.path} does not decode ({error}); {REMEDY}",
                    ) from error
            for glimpse, step in zip(found, wanted, strict=True):
                glimpse[spec.path.removeprefix("images/")] = blocks[step // size][step % size]
    return found
