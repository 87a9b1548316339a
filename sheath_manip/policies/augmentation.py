"""What may be done to training images without changing what the expert would do."""

from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from sheath_manip.types import Mirror
from sheath_manip.types.samples import Samples


@dataclass(frozen=True)
class Moves:
    """What is done to each image of a batch."""

    mirrored: NDArray[np.bool_]
    """(n,) which of them are turned about, left to right, before they are shifted"""
    offsets: NDArray[np.int64]
    """(n, 2) pixels down and to the right"""


def drawn_shifts(mirrored: NDArray[np.bool_], most_px: int, rng: np.random.Generator) -> Moves:
    """Return moves of (n,) images, each by up to `most_px` pixels in both directions.

    Random shifts are the augmentation that pays most for image policies (Kostrikov et al. 2021,
    'Image augmentation is all you need'). What leaves on one side enters on the other.
    """
    if most_px == 0:
        return Moves(mirrored, np.zeros((len(mirrored), 2), np.int64))
    return Moves(mirrored, rng.integers(-most_px, most_px + 1, (len(mirrored), 2)))


def moved(images: NDArray[np.uint8], moves: Moves) -> NDArray[np.uint8]:
    """(n, h, w, 3) images, each mirrored and shifted as `moves` says."""
    height, width = images.shape[1:3]
    done = np.empty_like(images)
    offsets = (moves.offsets % (height, width)).tolist()
    for image, shown, turned, (down, right) in zip(
        images, done, moves.mirrored.tolist(), offsets, strict=True
    ):
        # By the four parts that it falls into; np.roll takes four times as long.
        before = cv2.flip(image, 1) if turned else image
        shown[down:, right:] = before[: height - down, : width - right]
        shown[:down, right:] = before[height - down :, : width - right]
        shown[down:, :right] = before[: height - down, width - right :]
        shown[:down, :right] = before[height - down :, width - right :]
    return done


def noisy(
    features: NDArray[np.float32], deviation: float, rng: np.random.Generator
) -> NDArray[np.float32]:
    """(n, f) features, each with normal noise of that standard deviation."""
    noise = rng.standard_normal(features.shape, np.float32)
    noise *= deviation
    noise += features
    return noise


def half_of_them(count: int, mirror: Mirror | None, rng: np.random.Generator) -> NDArray[np.bool_]:
    """(count,) about half of the states, drawn to be mirrored; none without a mirror."""
    return np.zeros(count, bool) if mirror is None else rng.random(count) < 0.5


def reflected(samples: Samples, mirror: Mirror | None, which: NDArray[np.bool_]) -> Samples:
    """`samples` without images, those (n,) `which` as they are on the other side of the mirror."""
    if mirror is None:
        return replace(samples, images={})
    signs = np.where(which[:, None], np.array(mirror.features, np.float32), 1)
    turned = np.where(which[:, None], np.array(mirror.action, np.float32), 1)
    return replace(
        samples, images={}, features=samples.features * signs, labels=samples.labels * turned
    )
