"""A dm_control environment, of the suite or of composer, as gymnasium has it."""

from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray


class DmControlGymnasium(gymnasium.Env):
    """Runs `inner`; what it renders is what `camera` of its model sees."""

    metadata = {"render_modes": ["rgb_array"]}  # noqa: RUF012 - as gymnasium declares it
    render_mode = "rgb_array"

    def __init__(self, inner: Any, camera: int | str = -1, size_px: tuple[int, int] = (84, 84)):
        self.inner = inner
        self.dt = inner.control_timestep()
        self._camera, self._size_px = camera, size_px
        action = inner.action_spec()
        self.action_space = spaces.Box(
            np.broadcast_to(action.minimum, action.shape).astype(np.float64),
            np.broadcast_to(action.maximum, action.shape).astype(np.float64),
            action.shape,
            np.float64,
        )
        specs = inner.observation_spec()
        self.observation_space = spaces.Dict({key: _space(spec) for key, spec in specs.items()})

    @property
    def physics(self) -> Any:
        """dm_control's physics, for experts and judges."""
        return self.inner.physics

    @property
    def model(self) -> Any:
        """MuJoCo's model."""
        return self.physics.model.ptr

    @property
    def data(self) -> Any:
        """MuJoCo's data."""
        return self.physics.data.ptr

    @property
    def max_episode_steps(self) -> int | None:
        """The time limit, None where there is none."""
        # The suite counts steps, composer seconds.
        limit = getattr(self.inner, "_step_limit", None)
        limit = getattr(self.inner, "_time_limit", np.inf) / self.dt if limit is None else limit
        return round(limit) if np.isfinite(limit) else None

    def reset(self, *, seed: int | None = None, options: Any = None) -> tuple[Any, dict[str, Any]]:
        """Start an episode."""
        super().reset(seed=seed, options=options)
        if seed is not None:
            self._random.seed(seed)
        return self.inner.reset().observation, {}

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """Run one control step; an end with discount 0 is the task's own."""
        at = self.inner.step(action)
        own = at.last() and at.discount == 0
        return at.observation, float(at.reward or 0.0), own, at.last() and not own, {}

    def render(self) -> NDArray[np.uint8]:
        """(h, w, 3) what the camera sees."""
        height, width = self._size_px
        return self.physics.render(height=height, width=width, camera_id=self._camera)

    def close(self) -> None:
        """Free what the simulator holds."""
        self.inner.close()

    def memory(self) -> NDArray[np.float64]:
        """(1,) the suite's own count of steps."""
        return np.array([getattr(self.inner, "_step_count", 0)], np.float64)

    def recall(self, memory: NDArray[np.float64]) -> None:
        """Take it back; the next step is none that begins an episode."""
        if hasattr(self.inner, "_step_count"):
            self.inner._step_count = int(memory[0])
        self.inner._reset_next_step = False

    def _get_obs(self) -> Any:
        updater = getattr(self.inner, "_observation_updater", None)
        if updater is None:
            return self.inner.task.get_observation(self.physics)
        # Composer's buffers are filled anew with the present moment.
        updater.reset(self.physics, self._random)
        return updater.get_observation()

    @property
    def _random(self) -> np.random.RandomState:
        # Composer's environment has its own, the suite's task.
        own = getattr(self.inner, "random_state", None)
        return self.inner.task.random if own is None else own


def _space(spec: Any) -> spaces.Box:
    if spec.dtype == np.uint8:
        return spaces.Box(0, 255, spec.shape, np.uint8)
    return spaces.Box(-np.inf, np.inf, spec.shape, np.float64)
