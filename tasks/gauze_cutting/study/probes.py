"""States that the gauze expert does not come to, and its regret of an action.

What is displaced is the blade; the sheet and its cut stay as they are.
"""

from functools import partial

import numpy as np
from numpy.typing import NDArray

from sheath_manip.experiments.probes import Displacement, Probes
from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.gauze_cutting.expert import GauzeExpert, task_of
from sheath_manip.types import Action, Observation

HORIZON_S = 0.2
"""for which an action is held to see where it leads"""
COSTLY_MM = 2.0
"""from where the expert would be by then: two thirds of what ruins the sheet"""


def beside(distance_mm: float, environment: ComposerEnvironment, rng: np.random.Generator):
    """Put the blade beside the line, to either side of where it is."""
    task = task_of(environment)
    outwards = task.scene.rotation @ (task.knife.path_m[-1] / np.linalg.norm(task.knife.path_m[-1]))
    return _displaced(
        environment, rng.choice([-1e-3, 1e-3]) * distance_mm * np.append(outwards, 0.0)
    )


def lifted(height_mm: float, environment: ComposerEnvironment, rng: np.random.Generator):
    """Draw the blade out of the sheet."""
    del rng
    return _displaced(environment, np.array([0.0, 0.0, 1e-3 * height_mm]))


def regret(expert: GauzeExpert, action: Action) -> float:
    """How far (mm) from the expert's way (2,) `action` leads within a fifth of a second."""
    task = expert.task
    velocity = task.scenario.steering.velocity_m_s(action, task.heading)
    return float(1e3 * HORIZON_S * np.linalg.norm(velocity - expert.velocity_m_s()))


PROBES = Probes(
    displacements=(
        # An expert whose sheet is pulled away comes as far from the line as the first.
        Displacement("beside 1 mm", partial(beside, 1.0), far=False),
        Displacement("beside 2 mm", partial(beside, 2.0)),
        Displacement("beside 4 mm", partial(beside, 4.0)),
        Displacement("lifted 20 mm", partial(lifted, 20.0)),
    ),
    regret=regret,
    costly_regret=COSTLY_MM,
)


def _displaced(environment: ComposerEnvironment, shift_m: NDArray) -> Observation:
    """Look from where the tip is moved by (3,)."""
    task = task_of(environment)
    task.place_tip(task.tip_m + shift_m)
    environment.physics.forward()
    return environment.observe()
