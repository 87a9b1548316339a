"""Pictures of gauze cutting for films: larger than what the policy sees."""

import numpy as np
from numpy.typing import NDArray

from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.rendering import wide_picture


def film_frame(environment: ComposerEnvironment) -> NDArray[np.uint8]:
    """(320, 640, 3) RGB of the sheet and the blade from the side, as they stand."""
    return wide_picture(environment.physics, "side")
