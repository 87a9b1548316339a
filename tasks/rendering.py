"""Camera pictures at the price of the picture alone."""

import cv2
import mujoco
import numpy as np
from dm_control.mujoco import engine
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError

WIDE_PX = (320, 640)
"""(height, width) of pictures for films"""


def wide_picture(physics: engine.Physics, camera: str) -> NDArray[np.uint8]:
    """(320, 640, 3) RGB of what the camera sees and what is beside it, for films."""
    height, width = WIDE_PX
    return engine.Camera(physics, height=height, width=width, camera_id=camera).render().copy()


class PyramidCamera:
    """A fixed camera whose renderer is kept, followed by levels of a Gaussian pyramid.

    `physics.render` builds a camera at each call, which costs more than the picture; this one is
    rebuilt only when the model was compiled anew.
    """

    def __init__(self, name: str, size_px: int, pyramid_levels: int) -> None:
        if size_px < 8 or pyramid_levels < 0:
            raise ParameterError(
                f"camera of {size_px} px with {pyramid_levels} pyramid levels; "
                "wanted at least 8 px and 0 levels"
            )
        self._name = name
        self._size_px = size_px
        self._levels = pyramid_levels
        self._camera: engine.Camera | None = None
        self._model: mujoco.MjModel | None = None

    @property
    def shape(self) -> tuple[int, int]:
        """The (height, width) in pixels of what `__call__` returns."""
        size = self._size_px
        for _ in range(self._levels):
            size = (size + 1) // 2
        return size, size

    def __call__(self, physics: engine.Physics) -> NDArray[np.uint8]:
        """Return a picture, (h, w, 3) RGB."""
        if self._camera is None or self._model is not physics.model.ptr:
            self._model = physics.model.ptr
            self._camera = engine.Camera(
                physics, height=self._size_px, width=self._size_px, camera_id=self._name
            )
        image = self._camera.render()
        for _ in range(self._levels):
            image = cv2.pyrDown(image)
        return np.ascontiguousarray(image)
