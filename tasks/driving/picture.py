"""Pictures of driving for films: sharper than what the policy sees, and wider."""

import numpy as np
from numpy.typing import NDArray

from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.driving.track import GRASS
from sheath_manip.tasks.rendering import wide_picture


def film_frame(environment: ComposerEnvironment) -> NDArray[np.uint8]:
    """(320, 640, 3) RGB of the road around the car, from above and turned with it."""
    picture = wide_picture(environment.physics, "car/overhead")
    # So wide a view looks over the ground's edge, where nothing is drawn.
    picture[(picture == 0).all(axis=-1)] = GRASS
    return picture
