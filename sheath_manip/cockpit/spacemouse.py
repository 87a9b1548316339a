"""Reads a SpaceMouse that is plugged in here (pyspacemouse), beside the page."""

import threading
from typing import Any

import numpy as np

from sheath_manip.cockpit.cockpit import Cockpit
from sheath_manip.exceptions import SetupError
from sheath_manip.protocols.closing import Closes
from sheath_manip.types.operator_input import SixAxes

DEAD_ZONE = 0.08
"""of each axis' way, which a cap at rest does not leave"""
_PERIOD_S = 0.01
MOST_REPORTS = 100
"""that are read in one go"""


class SpaceMouse(Closes):
    """Hands its readings to a cockpit from a thread of its own, until it is closed."""

    def __init__(self, cockpit: Cockpit) -> None:
        """Raises SetupError where the package or the device is missing."""
        try:
            import pyspacemouse  # pyright: ignore[reportMissingImports] - an extra
        except ImportError as error:
            raise SetupError(
                "a SpaceMouse wants the package pyspacemouse; `pip install -e '.[spacemouse]'`"
            ) from error
        try:
            device: Any = pyspacemouse.open()
        except Exception as error:
            raise SetupError(
                f"the SpaceMouse does not open ({error}); is it plugged in?"
            ) from error
        if not device:
            raise SetupError("there is no SpaceMouse; wanted one plugged in and readable")
        # The package's version 1 reads the one open device, version 2 the one that it returned.
        self._device: Any = device if hasattr(device, "read") else pyspacemouse
        self._cockpit = cockpit
        self._told_at: float | None = None
        """of the newest report, by the device's package"""
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._run, name="SpaceMouse", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Stop reading."""
        self._closing.set()
        self._thread.join(1.0)
        self._device.close()

    def _run(self) -> None:
        while not self._closing.wait(_PERIOD_S):
            state = self._newest()
            if state is not None:
                self._cockpit.turn_axes(six_axes(state))

    def _newest(self) -> Any:
        """What the device has said since it was last asked; None where it has said nothing.

        Without a new report `read` returns the last one again, also of a device that is out of
        reach, so that only its time tells. Reports that have queued up are passed over.
        """
        newest = None
        for _ in range(MOST_REPORTS):
            state = self._device.read()
            if state is None or state.t == self._told_at:
                break
            newest, self._told_at = state, state.t
        return newest


def six_axes(state: Any) -> SixAxes:
    """A reading (x right, y forward, z up, each -1..1) in the world frame of a table before one."""
    turns = (state.roll, state.pitch, -state.yaw)
    raw = np.array([state.y, -state.x, state.z, *turns], np.float64)
    raw = np.clip(np.nan_to_num(raw, nan=0.0), -1.0, 1.0)
    twist = np.where(np.abs(raw) > DEAD_ZONE, raw, 0.0)
    pressed = [bool(button) for button in (*state.buttons, 0, 0)][:2]
    return SixAxes(twist, (pressed[0], pressed[1]))
