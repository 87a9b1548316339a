"""Pictures of gauze cutting for films: larger than what the policy sees."""

import numpy as np
from numpy.typing import NDArray

from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.rendering import PyramidCamera

SIZE_PX = 288


def film_frame(environment: ComposerEnvironment) -> NDArray[np.uint8]:
    """(288, 288, 3) RGB of the sheet and the blade from the side, as they stand."""
    return PyramidCamera("side", SIZE_PX, pyramid_levels=0)(environment.physics)
