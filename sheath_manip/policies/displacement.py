"""Pictures of where the robot could be and never was, made from those of where it was.

They say in which directions of an embedding a displaced robot shows. No expert labels them, no
policy is trained on them and none counts as training state.
"""

from collections.abc import Mapping

import cv2
import numpy as np
from numpy.typing import NDArray

# Beyond what an expert does and what the network's own shifts in training cover.
ROTATION_DEG = (30.0, 120.0)
SHIFT_OF_WIDTH = (0.12, 0.28)
ROTATED_SHARE = 0.6

# What changes by less is the robot's own body, which stays in place when the scene moves.
LEAST_GREY_LEVELS = 8.0
# Enough to tell what never moves.
COMPARED_IMAGES = 300


def displaced(
    images: Mapping[str, NDArray[np.uint8]], rng: np.random.Generator, count: int
) -> dict[str, NDArray[np.uint8]]:
    """(count, h, w, 3) images by camera: training images turned about their middle or moved aside.

    It is assumed that each camera moves with the robot and looks along an axis about which the
    robot can turn, as one from above does: then a turned or shifted picture is what it sees when it
    stands askew or aside. For a fixed camera it is a displaced scene. Pixels that never change in
    training, the robot's own body, stay where they are. All cameras are moved alike.

    Args:
        images: (n, h, w, 3) training images by camera, n >= 1.
        rng: draws the images and their displacements.
        count: of the displaced images.
    """
    total = len(next(iter(images.values())))
    chosen = rng.integers(total, size=count)
    signs = rng.choice([-1.0, 1.0], count)
    rotated = rng.random(count) < ROTATED_SHARE
    angles_deg = np.where(rotated, signs * rng.uniform(*ROTATION_DEG, count), 0.0)
    shifts = np.where(rotated, 0.0, signs * rng.uniform(*SHIFT_OF_WIDTH, count))
    return {camera: _warped(array, chosen, angles_deg, shifts) for camera, array in images.items()}


def _warped(
    images: NDArray[np.uint8], chosen: NDArray, angles_deg: NDArray, shifts: NDArray
) -> NDArray[np.uint8]:
    height, width = images.shape[1:3]
    rows, columns = np.nonzero(_never_changing(images))
    warped = np.empty((len(chosen), *images.shape[1:]), np.uint8)
    for number, index in enumerate(chosen):
        motion = cv2.getRotationMatrix2D(
            ((width - 1) / 2, (height - 1) / 2), float(angles_deg[number]), 1.0
        )
        motion[0, 2] += shifts[number] * width
        cv2.warpAffine(
            images[index],
            motion,
            (width, height),
            dst=warped[number],
            flags=cv2.INTER_LINEAR,
            borderMode=cv2.BORDER_REFLECT,
        )
    warped[:, rows, columns] = images[:, rows, columns][chosen]
    return warped


def _never_changing(images: NDArray[np.uint8]) -> NDArray[np.bool_]:
    """(h, w) where no channel changes among the images."""
    compared = images[:: -(-len(images) // COMPARED_IMAGES)].astype(np.float32)
    return compared.std(axis=0).max(axis=-1) < LEAST_GREY_LEVELS
