"""Pictures of the grasp in clutter for films: larger than what the policy sees."""

import numpy as np
from numpy.typing import NDArray

from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.grasp_clutter.task import GraspTask
from sheath_manip.tasks.rendering import wide_picture


def film_frame(environment: ComposerEnvironment) -> NDArray[np.uint8]:
    """(320, 640, 3) RGB of the scene from the front, as it stands."""
    if not isinstance(environment.task, GraspTask):
        raise TypeError(f"wanted the environment of a GraspTask, got {environment.task!r}")
    return wide_picture(environment.physics, environment.task.camera_name("front"))
