"""An episode as it is stored: its header and its arrays."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from sheath_manip.dataset.header import Header
from sheath_manip.types.columns import stacked


class Rows(Protocol):
    """An array of T rows, or what gives some of them at a time: images of a run lie apart."""

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape, T first."""
        ...

    @property
    def dtype(self) -> np.dtype[Any]:
        """The type."""
        ...

    def __getitem__(self, rows: Any, /) -> Any:
        """Return some rows, for a tuple of one slice."""
        ...


class Frames:
    """(T, h, w, 3) images that are stacked only where they are asked for: none lies there twice."""

    def __init__(self, images: Sequence[NDArray]) -> None:
        """Store them; raises ValueError where they are of several shapes or types."""
        if len({(image.shape, image.dtype) for image in images}) != 1:
            raise ValueError("all must have the same shape and type")
        self._images = images
        self.shape = (len(images), *images[0].shape)
        self.dtype = images[0].dtype

    def __getitem__(self, rows: tuple[slice, ...]) -> NDArray:
        return stacked(self._images[rows[0]])


@dataclass(frozen=True, eq=False)
class Recorded:
    """One episode by column instead of by step, which is how files of all formats hold it."""

    header: Header
    arrays: Mapping[str, Any]
    """those of `layout(header)`: all NDArray where they were read; of a run the images are Rows"""
