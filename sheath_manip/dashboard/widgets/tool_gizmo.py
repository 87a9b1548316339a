"""A gizmo on the tool: who drives drags the tool along."""

import numpy as np
import viser

from sheath_manip.cockpit import Cockpit
from sheath_manip.dashboard.changed import set_changed
from sheath_manip.dashboard.operator_socket import station_of
from sheath_manip.dashboard.scene import WORLD
from sheath_manip.dashboard.snapshot import Snapshot
from sheath_manip.dashboard.widget import WidgetContext

SCALE_M, SHARE_OF_VIEW = 0.14, 0.25
"""length of its arrows, the second one as a share of what is seen around the tool at first"""


class ToolGizmo:
    """Lies on the tool while nobody drags it; visible while a person drives a robot with a tool."""

    def __init__(self, context: WidgetContext, cockpit: Cockpit) -> None:
        self._cockpit = cockpit
        self._dragged_by: int | None = None
        view = context.spec.first_view
        self.handle = context.viser.scene.add_transform_controls(
            f"{WORLD}/tool_gizmo",
            scale=SCALE_M if view is None else SHARE_OF_VIEW * view.radius_m,
            active_axes=(True, True, not cockpit.planar),
            disable_rotations=cockpit.planar,
            depth_test=False,
            visible=False,
        )

        @self.handle.on_update
        async def _(event: viser.TransformControlsEvent) -> None:
            if event.client_id is not None:
                self._follow(event.client_id, event.phase)

    def draw(self, snapshot: Snapshot) -> None:  # noqa: ARG002
        """Put it where the tool is, unless somebody drags it."""
        pose, state = self._cockpit.tool_pose, self._cockpit.state
        if self._dragged_by is not None and state.operator != station_of(self._dragged_by):
            self._dragged_by = None
        set_changed(self.handle, visible=pose is not None and state.taken and not state.stopped)
        if pose is not None and self._dragged_by is None:
            self.handle.position, self.handle.wxyz = pose[:3], pose[3:]

    def _follow(self, client_id: int, phase: str) -> None:
        station = station_of(client_id)
        if phase == "end":
            self._cockpit.drag(station, None)
            self._dragged_by = None
        elif self._cockpit.drag(station, np.concatenate([self.handle.position, self.handle.wxyz])):
            self._dragged_by = client_id
