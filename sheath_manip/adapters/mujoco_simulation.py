"""The MuJoCo model and data behind somebody else's environment: its state, and how it stands.

Imported only where the environment has brought MuJoCo.
"""

from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from sheath_manip.adapters.mujoco_scene import scene_geoms
from sheath_manip.exceptions import ParameterError
from sheath_manip.types import SceneGeom, ScenePose

_STATE = mujoco.mjtState.mjSTATE_INTEGRATION
_DERIVED = (
    "xpos",
    "xquat",
    "xmat",
    "xipos",
    "ximat",
    "geom_xpos",
    "geom_xmat",
    "site_xpos",
    "site_xmat",
    "cam_xpos",
    "cam_xmat",
    "subtree_com",
    "cinert",
    "cdof",
    "cvel",
    "cfrc_ext",
    "actuator_force",
    "qfrc_actuator",
    "sensordata",
)
"""what MuJoCo computes before it moves on: after a step it is one substep older than the positions,
and environments observe it so, and act on it"""


@dataclass(frozen=True)
class MujocoSimulation:
    """Reads, writes and shows the simulation of an environment that has `model` and `data`."""

    environment: Any
    """unwrapped; its model and data may be others after a reset"""
    tool: str = ""
    """name of the site or body whose way viewers draw; empty for none"""

    @staticmethod
    def is_behind(environment: Any) -> bool:
        """Whether an unwrapped environment has what this needs."""
        return isinstance(getattr(environment, "model", None), mujoco.MjModel) and isinstance(
            getattr(environment, "data", None), mujoco.MjData
        )

    def state(self) -> NDArray[np.float64]:
        """(s,) all that it takes to go on from here to the bit."""
        model, data = self._now
        simulator = np.empty(mujoco.mj_stateSize(model, _STATE))
        mujoco.mj_getState(model, data, simulator, _STATE)
        return np.concatenate([simulator, *(np.ravel(getattr(data, each)) for each in _DERIVED)])

    def restore(self, state: NDArray[np.float64]) -> None:
        """Return to a `state()`; raises ParameterError for one of another simulation."""
        model, data = self._now
        size = mujoco.mj_stateSize(model, _STATE)
        arrays = [getattr(data, each) for each in _DERIVED]
        wanted = size + sum(array.size for array in arrays)
        if len(state) != wanted:
            raise ParameterError(f"a simulator state of {len(state)} numbers; wanted {wanted}")
        simulator = np.array(state[:size])
        mujoco.mj_setState(model, data, simulator, _STATE)
        mujoco.mj_forward(model, data)
        # Once more, since that has warmed up the solver for the next step.
        mujoco.mj_setState(model, data, simulator, _STATE)
        for array in arrays:
            array.flat[:] = state[size : size + array.size]
            size += array.size

    def scene(self) -> list[SceneGeom]:
        """The visible shapes."""
        return scene_geoms(self._now[0])

    def pose(self) -> ScenePose:
        """Return how the scene stands now."""
        model, data = self._now
        bodies = np.concatenate([data.xpos, data.xquat], axis=1)
        touching = data.contact.dist <= 0
        return ScenePose(bodies, self._tool_m(model, data), data.contact.pos[touching])

    @property
    def _now(self) -> tuple[Any, Any]:
        return self.environment.model, self.environment.data

    def _tool_m(self, model: Any, data: Any) -> NDArray[np.float64] | None:
        if not self.tool:
            return None
        for kind, positions in (
            (mujoco.mjtObj.mjOBJ_SITE, data.site_xpos),
            (mujoco.mjtObj.mjOBJ_BODY, data.xpos),
        ):
            if (index := mujoco.mj_name2id(model, kind, self.tool)) >= 0:
                return positions[index].copy()
        raise ParameterError(f"no site and no body {self.tool!r} in the model, the `tool` to show")
