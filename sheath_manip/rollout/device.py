"""Which device computes: the CPU, which is the reference to the bit, or a CUDA device.

Policies, embeddings, the support and the search for precedents ask for the device of their process
when they are made, as numpy asks for its number of threads. A checkpoint holds plain numbers, so it
loads wherever it is read.
"""

import os
from typing import TYPE_CHECKING

from sheath_manip.exceptions import ParameterError, SetupError

if TYPE_CHECKING:
    import torch

VARIABLE = "SHEATH_DEVICE"
"""of the environment: what the device is called; worker processes take it over"""
CPU, CUDA, AUTO = "cpu", "cuda", "auto"
WANTED = f"{CPU}, {CUDA}, {CUDA}:N for device N, or {AUTO}: {CUDA} where there is one"


def use_device(name: str | None) -> None:
    """Let this process and those that it starts compute on the device called `name`.

    None leaves it as it is: that of SHEATH_DEVICE, or the CPU. Raises ParameterError for what is no
    device, and SetupError for one that torch does not find here.
    """
    if name is None and VARIABLE not in os.environ:
        return
    found = _found(os.environ[VARIABLE] if name is None else name)
    # What `auto` comes to is settled here, not in each worker anew.
    os.environ[VARIABLE] = found


def computes_on() -> str:
    """Return the name of the device that computes, such as `cpu` or `cuda:0`.

    Raises as `use_device` does.
    """
    name = os.environ.get(VARIABLE, CPU)
    return CPU if name == CPU else _found(name)


def torch_device() -> "torch.device":
    """Return the device that computes, as torch has it; raises as `use_device` does."""
    import torch

    return torch.device(computes_on())


def is_cpu() -> bool:
    """Tell whether the CPU computes; raises as `use_device` does."""
    return computes_on() == CPU


def _found(name: str) -> str:
    kind, colon, number = name.strip().lower().partition(":")
    if kind not in (CPU, CUDA, AUTO) or (colon and not (kind == CUDA and number.isdecimal())):
        raise ParameterError(f"the device is {name!r}; wanted {WANTED}")
    if kind == CPU:
        return CPU
    # Only now: torch takes seconds to import, and the CPU does without.
    import torch

    count = torch.cuda.device_count()
    if count == 0 and kind == AUTO:
        return CPU
    place = int(number or 0)
    if place >= count:
        raise SetupError(
            f"the device {name!r} is not here: torch {torch.__version__} finds {count} CUDA "
            f"devices; wanted --device {CPU}, or a torch built for the driver of this machine "
            "(pytorch.org), and a number below theirs"
        )
    # By default torch rounds the products of convolutions to 10 bits there; scores need all.
    torch.backends.cudnn.allow_tf32 = False
    return f"{CUDA}:{place}"
