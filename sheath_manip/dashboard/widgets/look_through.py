"""The scene as one of the policy's cameras has it, drawn as sharp as the page draws everything."""

import numpy as np
import viser
from numpy.typing import NDArray

from sheath_manip.dashboard.following import Following
from sheath_manip.dashboard.snapshot import Snapshot
from sheath_manip.dashboard.widget import WidgetContext
from sheath_manip.types import CameraPose

FREE: str = "free"
_View = tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64], float]
"""position, look-at and up of a browser's view, and its field of view"""


class LookThrough:
    """Puts every browser's view where the chosen camera is, and goes along with it.

    The browser draws, so that it costs the control loop nothing; what the policy has of the same
    view, in its few pixels, is in a window of its own.
    """

    def __init__(self, context: WidgetContext, following: Following) -> None:
        self._viser = context.viser
        self._following = following
        self._before: dict[int, _View] = {}
        """of each browser, while it looks through a camera"""
        self.choice: viser.GuiDropdownHandle[str] = context.viser.gui.add_dropdown(
            "View", (FREE,), hint="look through a camera of the policy", visible=False
        )

        @self.choice.on_update
        async def _(_: viser.GuiEvent) -> None:
            context.wake()

    def draw(self, snapshot: Snapshot) -> None:
        """Move the views; a view that follows the tool is free."""
        cameras = snapshot.pose.cameras
        if tuple(self.choice.options) != (FREE, *cameras):
            self.choice.options = (FREE, *cameras)
            self.choice.visible = bool(cameras)
        chosen = None if self._following.on else cameras.get(self.choice.value)
        clients = self._viser.get_clients()
        self._before = {each: view for each, view in self._before.items() if each in clients}
        for number, client in clients.items():
            if chosen is not None:
                if number not in self._before:
                    self._before[number] = _view(client.camera)
                _look(client.camera, chosen)
            elif number in self._before:
                _restore(client.camera, self._before.pop(number))


def _view(camera: viser.CameraHandle) -> _View:
    return (
        np.array(camera.position),
        np.array(camera.look_at),
        np.array(camera.up_direction),
        float(camera.fov),
    )


def _look(camera: viser.CameraHandle, pose: CameraPose) -> None:
    if not np.allclose(camera.position, pose.position_m, atol=1e-5):
        camera.position = pose.position_m
    if abs(float(np.dot(camera.wxyz, pose.wxyz))) < 1 - 1e-7:
        camera.wxyz = pose.wxyz
    if abs(camera.fov - pose.fov_rad) > 1e-4:
        camera.fov = pose.fov_rad


def _restore(camera: viser.CameraHandle, view: _View) -> None:
    camera.up_direction = view[2]
    camera.position = view[0]
    camera.look_at = view[1]
    camera.fov = view[3]
