"""Batches of training images: the same bytes from the CPU's memory and from a device's."""

import numpy as np
import pytest
import torch

from sheath_manip.policies.augmentation import drawn_shifts, moved
from sheath_manip.policies.pictures import HostPictures, Pictures, ResidentPictures, pictures_of

HERE = torch.device("cpu")


@pytest.fixture(scope="module")
def images() -> np.ndarray:
    return np.random.default_rng(0).integers(0, 256, (30, 9, 7, 3), np.uint8)


@pytest.mark.parametrize("most_px", [0, 1, 3])
@pytest.mark.parametrize("kept", [HostPictures, ResidentPictures])
def test_a_batch_is_what_the_moves_make_of_its_images(images, kept, most_px):
    rng = np.random.default_rng(1)
    batch = rng.permutation(len(images))[:12]
    moves = drawn_shifts(rng.random(12) < 0.5, most_px, rng)
    pictures: Pictures = kept(images, HERE)
    shown = pictures.shown(batch, moves)
    for number, place in enumerate(batch):
        image = images[place, :, ::-1] if moves.mirrored[number] else images[place]
        expected = np.roll(image, tuple(moves.offsets[number]), axis=(0, 1))
        np.testing.assert_array_equal(shown[number].numpy(), expected)
    np.testing.assert_array_equal(shown.numpy(), moved(images[batch], moves))


def test_moved_images_are_others_than_those_that_are_kept(images):
    before = images.copy()
    moves = drawn_shifts(np.ones(4, bool), 0, np.random.default_rng(0))
    moved(images[:4], moves)[:] = 0
    np.testing.assert_array_equal(images, before)


def test_on_the_cpu_nothing_is_copied_beforehand(images):
    assert isinstance(pictures_of(images, HERE), HostPictures)
