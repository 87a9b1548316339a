"""A stand-in for a device: the code that computes on one, run by torch on the CPU."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from unittest.mock import patch

from sheath_manip.rollout import device


@contextmanager
def computing_on(name: str) -> Iterator[None]:
    """Let all that is made meanwhile compute there; `cpu:0` is the CPU by the device's code."""
    found = {"_found": lambda said: said} if name == "cpu:0" else {}
    with patch.dict(os.environ, {device.VARIABLE: name}), patch.multiple(device, **found):
        yield
