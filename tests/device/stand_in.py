"""A stand-in for a device: the code that computes on one, run by torch on the CPU."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from unittest.mock import patch

from sheath_manip.rollout import device

STAND_IN = "cpu:0"


@contextmanager
def computing_on(name: str) -> Iterator[None]:
    """Let all that is made meanwhile compute there; `cpu:0` is the CPU by the device's code."""
    with patch.dict(os.environ, {device.VARIABLE: name}):
        if name != STAND_IN:
            yield
            return
        with patch.object(device, "_found", lambda said: said):
            yield
