"""What the policy sees, in a window of its own."""

import cv2
import numpy as np
import viser
from numpy.typing import NDArray

from sheath_manip.dashboard.changed import set_changed
from sheath_manip.dashboard.rate_limiter import RateLimiter
from sheath_manip.dashboard.snapshot import Snapshot
from sheath_manip.dashboard.widget import WidgetContext

WIDTH_PX = 220
"""no less: viser would cut off what is in the window"""
MARGIN_PX = 15
RATE_HZ = 6.0


class Cameras:
    """The latest image of each camera; no window where the task has none."""

    def __init__(self, context: WidgetContext) -> None:
        gui, cameras = context.viser.gui, context.spec.cameras
        self._limiter = RateLimiter(RATE_HZ)
        self._images: dict[str, viser.GuiImageHandle] = {}
        if not cameras:
            return
        blank = np.zeros((1, 1, 3), np.uint8)
        window = gui.add_panel()
        with window.add_tab("What the policy sees"):
            for name in cameras:
                label = name if len(cameras) > 1 else None
                self._images[name] = gui.add_image(
                    blank, label=label, jpeg_quality=85, visible=False
                )
        window.float(x=MARGIN_PX, y=MARGIN_PX, width=WIDTH_PX)

    def draw(self, snapshot: Snapshot) -> None:
        """Show what was seen before the shown step."""
        if snapshot.step is None:
            # Else another episode's last image, of another robot even, would pass for this one's.
            for handle in self._images.values():
                set_changed(handle, visible=False)
            return
        if not self._limiter.should_draw(snapshot):
            return
        for name, image in snapshot.step.observation.images.items():
            if name in self._images:
                self._images[name].image = _enlarged(image)
                set_changed(self._images[name], visible=True)


def _enlarged(image: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """A policy's small image with every pixel repeated: the page shows images as they are."""
    times = -(-WIDTH_PX // image.shape[1])
    size = times * image.shape[1], times * image.shape[0]
    return np.asarray(cv2.resize(image, size, interpolation=cv2.INTER_NEAREST), np.uint8)
