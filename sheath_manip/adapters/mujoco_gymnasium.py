"""A gymnasium environment with MuJoCo behind it: restorable to the bit, and shown in 3-D.

Imported only where the environment has brought MuJoCo.
"""

from collections.abc import Sequence

import gymnasium
import numpy as np
from numpy.typing import NDArray

from sheath_manip.adapters.gymnasium_environment import Terms
from sheath_manip.adapters.memory import MujocoMemory
from sheath_manip.adapters.mujoco_simulation import MujocoSimulation
from sheath_manip.adapters.restorable_gymnasium import RestorableGymnasium
from sheath_manip.types import SceneGeom, ScenePose


class MujocoGymnasium(RestorableGymnasium):
    """One with MuJoCo behind it."""

    def __init__(self, gym: gymnasium.Env, terms: Terms, tool: str) -> None:
        """`tool` names the site or body whose way viewers draw; empty for none."""
        self._simulation = MujocoSimulation(gym.unwrapped, tool)
        super().__init__(gym, terms, MujocoMemory(self._simulation))

    def scene(self) -> Sequence[SceneGeom]:
        """The visible shapes."""
        return self._simulation.scene()

    def pose(self) -> ScenePose:
        """Return how the scene stands now."""
        return self._simulation.pose()

    def pose_at(self, state: NDArray[np.float64]) -> ScenePose:
        """Return how the scene stood in `state`, at which the episode then stands."""
        self._take(state)
        return self.pose()
