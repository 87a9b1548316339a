"""A widget in the scene: the way of the tool, coloured by who acted, and where bodies touch."""

import numpy as np
import viser
from numpy.typing import NDArray

from sheath_manip.dashboard.changed import set_changed
from sheath_manip.dashboard.scene import WORLD
from sheath_manip.dashboard.snapshot import Snapshot
from sheath_manip.dashboard.widget import WidgetContext
from sheath_manip.playback import palette
from sheath_manip.types import ACTORS

TRAIL_STEPS = 400
"""the latest"""
THICKNESS_PX = 3.0
CONTACT_RGB = (255, 60, 60)
POINT_SHARE = 0.012
"""of the first view's radius: the size of a contact"""
POINT_M = 0.05
"""where there is no first view"""
COLOURS = np.array([palette.linear(palette.ACTOR[actor]) for actor in ACTORS], np.uint8)
"""(actors, 3) by place in ACTORS"""


class Trail:
    """The tool's trail: one line of segments, and one cloud of points."""

    def __init__(self, context: WidgetContext) -> None:
        scene, view = context.viser.scene, context.spec.first_view
        # viser takes no line without a segment.
        nothing = np.zeros((1, 2, 3), np.float32)
        self._line = scene.add_line_segments(
            f"{WORLD}/trail",
            nothing,
            nothing,
            thickness=THICKNESS_PX,
            thickness_units="screen",
            visible=False,
        )
        self._contacts = scene.add_point_cloud(
            f"{WORLD}/contacts",
            nothing[0],
            CONTACT_RGB,
            point_size=POINT_M if view is None else POINT_SHARE * view.radius_m,
            point_shape="circle",
            # Half precision is a tenth of a metre at the end of a long stage.
            precision="float32",
            visible=False,
        )

    def draw(self, snapshot: Snapshot) -> None:
        """Show the way up to the shown step."""
        shown = snapshot.trace.until(snapshot.at + 1)
        first = max(len(shown) - TRAIL_STEPS, 0)
        way = shown.tool_m[first:].astype(np.float32)
        drawable = len(way) > 1 and bool(np.isfinite(way).all())
        if drawable:
            colours = COLOURS[shown.actor[first + 1 :]]
            _set_line(self._line, np.stack([way[:-1], way[1:]], 1), colours)
        set_changed(self._line, visible=drawable)
        contacts = snapshot.pose.contacts_m
        if len(contacts):
            self._contacts.points = contacts.astype(np.float32)
        set_changed(self._contacts, visible=len(contacts) > 0)


def _set_line(
    line: viser.LineSegmentsHandle, points: NDArray[np.float32], colours: NDArray[np.uint8]
) -> None:
    """Set (n, 2, 3) points and (n, 3) colours of each segment."""
    line.points = points
    line.colors = np.repeat(colours[:, None], 2, axis=1)
