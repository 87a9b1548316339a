"""Images and layers shrunk by products, against the libraries that shrink them otherwise."""

import cv2
import numpy as np
import pytest
import torch
from torch.nn import functional

from sheath_manip.policies.shrinking import averaging, shrinking


@pytest.mark.parametrize("size", [(84, 84), (125, 125), (60, 97)])
@pytest.mark.parametrize(("side", "middle"), [(16, 1.0), (12, 0.4), (5, 0.5)])
def test_images_shrink_as_by_cv2(size, side, middle):
    height, width = size
    images = np.random.default_rng(0).integers(0, 256, (3, height, width, 3), dtype=np.uint8)
    top, left = round(height * (1 - middle) / 2), round(width * (1 - middle) / 2)
    shrunk = shrinking(height, width, side, middle).shrink(images)
    for image, found in zip(images, shrunk, strict=True):
        cut = image[top : height - top, left : width - left]
        expected = cv2.resize(cut, (side, side), interpolation=cv2.INTER_AREA)
        # Half a grey value may be rounded up or down.
        assert np.abs(found - expected.ravel()).max() <= 1
        assert np.mean(found == expected.ravel()) > 0.99


def test_a_layer_is_averaged_as_by_torch():
    layer = torch.from_numpy(np.random.default_rng(0).normal(size=(2, 3, 20, 9)).astype(np.float32))
    expected = functional.adaptive_avg_pool2d(layer, 6).flatten(2).numpy()
    found = layer.flatten(2).numpy() @ averaging(20, 9, 6).T
    np.testing.assert_allclose(found, expected, atol=1e-6)
