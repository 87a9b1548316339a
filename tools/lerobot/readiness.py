"""What every run with LeRobot begins with."""

import logging
import os
import time
from collections.abc import Callable
from importlib import import_module
from importlib.metadata import version

from sheath_manip.dataset.extras import needs


def get_ready() -> None:
    """Import LeRobot offline, quiet and on one thread; raises SetupError where it is not there."""
    # Nothing is to be fetched, and no bar drawn for each episode that is written.
    os.environ |= {"HF_HUB_OFFLINE": "1", "HF_DATASETS_DISABLE_PROGRESS_BARS": "1"}
    with needs("lerobot", "lerobot"):
        import_module("lerobot")
        import_module("tools.readers.declare_torchvision")
    import torch

    torch.set_num_threads(1)
    logging.disable(logging.INFO)


def versions() -> dict[str, str]:
    """Return the versions that results depend on."""
    return {name: version(name) for name in ("lerobot", "torch", "mujoco")}


def timed_say() -> Callable[[str], None]:
    """Return what prints a line, and the seconds since now before it."""
    begin = time.perf_counter()

    def say(line: str) -> None:
        print(f"[{time.perf_counter() - begin:6.0f} s] {line}", flush=True)

    return say
