"""A widget in the scene: lines that move and grow."""

import numpy as np
import viser

from sheath_manip.dashboard.scene import WORLD
from sheath_manip.dashboard.snapshot import Snapshot
from sheath_manip.dashboard.widget import WidgetContext
from sheath_manip.playback import palette

THICKNESS_PX = 4.0


class Lines:
    """Lines in the scene: one viser node each, moved as it is."""

    def __init__(self, context: WidgetContext) -> None:
        self._scene = context.viser.scene
        self._lines: list[viser.LineSegmentsHandle] = []

    def draw(self, snapshot: Snapshot) -> None:
        """Show the snapshot's lines."""
        lines = snapshot.pose.lines
        while len(self._lines) > len(lines):
            self._lines.pop().remove()
        for index, line in enumerate(lines):
            if index == len(self._lines):
                self._lines.append(self._fresh(index))
            node, drawable = self._lines[index], len(line.points_m) > 1
            if drawable:
                segments = np.stack([line.points_m[:-1], line.points_m[1:]], axis=1)
                red, green, blue = (round(255 * channel) for channel in line.rgb)
                node.points = segments.astype(np.float32)
                node.colors = np.full(segments.shape, palette.linear((red, green, blue)), np.uint8)
            node.visible = drawable

    def _fresh(self, index: int) -> viser.LineSegmentsHandle:
        # viser takes no line without a segment.
        nothing = np.zeros((1, 2, 3), np.float32)
        return self._scene.add_line_segments(
            f"{WORLD}/lines/{index}",
            nothing,
            nothing,
            thickness=THICKNESS_PX,
            thickness_units="screen",
            visible=False,
        )
