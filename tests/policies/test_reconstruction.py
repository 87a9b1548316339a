import numpy as np
import pytest
import torch

from sheath_manip.policies.reconstruction import Decoder, reconstruction_loss


def test_pictures_have_4_times_the_layers_side():
    assert tuple(Decoder(5)(torch.zeros(2, 5, 6, 7)).shape) == (2, 3, 24, 28)


def test_the_target_is_the_image_averaged_by_area():
    rng = np.random.default_rng(0)
    blocks = rng.integers(0, 256, (2, 4, 6, 3), dtype=np.uint8)
    images = torch.from_numpy(blocks.repeat(5, axis=1).repeat(5, axis=2))
    painted = (torch.from_numpy(blocks).permute(0, 3, 1, 2).float() - 128) / 64
    assert float(reconstruction_loss(painted, images)) == pytest.approx(0, abs=1e-9)
    # 64 grey levels off everywhere.
    assert float(reconstruction_loss(painted + 1, images)) == pytest.approx(1)
