"""Import torchvision where its compiled operators do not load, as with a torch without CUDA.

Only the names of the operators are declared. LeRobot's datasets call none of them.
"""

import re
import sys

import torch

_library = torch.library.Library("torchvision", "DEF")
while True:
    try:
        import torchvision  # noqa: F401

        break
    except RuntimeError as error:
        missing = re.search(r"torchvision::(\w+) does not exist", str(error))
        if missing is None:
            raise
        _library.define(f"{missing[1]}(Tensor x) -> Tensor")
        for name in [name for name in sys.modules if name.startswith("torchvision")]:
            del sys.modules[name]
