"""What may be done to training images without changing what the expert would do."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sheath_manip.types import Mirror
from sheath_manip.types.samples import Samples


def shifted(images: NDArray[np.uint8], most_px: int, rng: np.random.Generator) -> NDArray[np.uint8]:
    """(n, h, w, 3) images, each moved by up to `most_px` pixels in both directions.

    Random shifts are the augmentation that pays most for image policies (Kostrikov et al. 2021,
    'Image augmentation is all you need'). What leaves on one side enters on the other.
    """
    if most_px == 0:
        return images
    moved = np.empty_like(images)
    for number, (down, right) in enumerate(rng.integers(-most_px, most_px + 1, (len(images), 2))):
        moved[number] = np.roll(images[number], (down, right), axis=(0, 1))
    return moved


def noisy(
    features: NDArray[np.float32], deviation: float, rng: np.random.Generator
) -> NDArray[np.float32]:
    """(n, f) features, each with normal noise of that standard deviation."""
    noise = rng.standard_normal(features.shape, np.float32)
    noise *= deviation
    noise += features
    return noise


def reflected(samples: Samples, mirror: Mirror, rng: np.random.Generator) -> Samples:
    """`samples`, about half of them replaced by their mirror images."""
    flipped = rng.random(len(samples)) < 0.5
    images = {}
    for camera, pictures in samples.images.items():
        images[camera] = pictures.copy()
        images[camera][flipped] = pictures[flipped, :, ::-1]
    signs = np.where(flipped[:, None], np.array(mirror.features, np.float32), 1)
    turned = np.where(flipped[:, None], np.array(mirror.action, np.float32), 1)
    return replace(
        samples, images=images, features=samples.features * signs, labels=samples.labels * turned
    )
