"""Images shrunk by area, as cv2's INTER_AREA does, by two products with matrices of whole numbers.

A control loop shrinks one image at a time, and there a product takes a fifth of cv2's time.
"""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Shrinking:
    """What is cut out of images of one size, and the matrices that shrink it."""

    rows: slice
    """of the image, that are looked at"""
    down: NDArray[np.float32]
    """(side, h) what each of the h rows adds to each row that is left"""
    across: NDArray[np.float32]
    """(3 w, 3 side) the same for columns, colour by colour"""
    area: np.float32
    """of one pixel that is left, in the units of the matrices"""

    def shrink(self, images: NDArray[np.uint8]) -> NDArray[np.float32]:
        """Return (n, 3 side²) grey values 0..255, whole ones, of (n, h, w, 3) images."""
        shrunk = np.empty((len(images), len(self.down), self.across.shape[1]), np.float32)
        for image, small in zip(images[:, self.rows], shrunk, strict=True):
            rows = image.reshape(len(image), -1).astype(np.float32)
            # Of images up to 256x256 all sums are whole numbers that float32 holds, so that the
            # order in which they are taken, which is BLAS's, does not matter.
            np.matmul(self.down @ rows, self.across, out=small)
        shrunk /= self.area
        # Of no images the size cannot be guessed.
        return np.rint(shrunk, out=shrunk).reshape(len(images), math.prod(shrunk.shape[1:]))


@lru_cache(maxsize=64)
def shrinking(height: int, width: int, side: int, middle: float) -> Shrinking:
    """Return what shrinks the `middle` share of an image's sides to `side` x `side` pixels."""
    top, left = (round(pixels * (1 - middle) / 2) for pixels in (height, width))
    down = _overlaps(height - 2 * top, side)
    across = np.zeros((side, width), np.float32)
    across[:, left : width - left] = _overlaps(width - 2 * left, side)
    # A row of the image has its colours side by side.
    by_colour = np.kron(across, np.eye(3, dtype=np.float32)).T
    area = np.float32((height - 2 * top) * (width - 2 * left))
    return Shrinking(slice(top, height - top), down, np.ascontiguousarray(by_colour), area)


def _overlaps(pixels: int, side: int) -> NDArray[np.float32]:
    """(side, pixels) how far each pixel lies in each of `side` equal parts, in 1/side pixels."""
    starts = np.arange(side)[:, None] * pixels
    ends = np.minimum(starts + pixels, np.arange(1, pixels + 1) * side)
    begins = np.maximum(starts, np.arange(pixels) * side)
    return np.maximum(ends - begins, 0).astype(np.float32)


@lru_cache(maxsize=64)
def averaging(height: int, width: int, side: int) -> NDArray[np.float32]:
    """(side², h w) what takes the means over the cells of a grid, which may overlap by a pixel.

    The cells are those of torch's adaptive pooling: whole pixels, from the cell's start rounded
    down to its end rounded up.
    """
    down, across = (_within(pixels, side) for pixels in (height, width))
    return np.kron(down, across)


def _within(pixels: int, side: int) -> NDArray[np.float32]:
    """(side, pixels) the share of each pixel that any of a part's area touches."""
    touched = _overlaps(pixels, side) > 0
    return (touched / touched.sum(axis=1, keepdims=True)).astype(np.float32)
