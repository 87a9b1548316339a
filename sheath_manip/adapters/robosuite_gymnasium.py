"""A robosuite environment as gymnasium has it."""

from collections.abc import Mapping
from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

IMAGE = "_image"
"""what the names of robosuite's images end in"""
JOINED = "-state"
"""what the names of its vectors of others end in"""


class RobosuiteGymnasium(gymnasium.Env):
    """Runs `inner`; observed are its single observables, not the vectors that join them."""

    def __init__(self, inner: Any) -> None:
        self.inner = inner
        self.dt = inner.control_timestep
        self.max_episode_steps = inner.horizon
        self.action_space = spaces.Box(*inner.action_spec, dtype=np.float64)
        # OpenGL's images stand on their heads.
        from robosuite import macros  # pyright: ignore[reportMissingImports]

        self._flips = macros.IMAGE_CONVENTION == "opengl"
        seen = self._taken(inner.observation_spec())
        self.observation_space = spaces.Dict({key: _space(key, seen[key]) for key in seen})

    @property
    def model(self) -> Any:
        """MuJoCo's model."""
        return self.inner.sim.model._model

    @property
    def data(self) -> Any:
        """MuJoCo's data."""
        return self.inner.sim.data._data

    def reset(self, *, seed: int | None = None, options: Any = None) -> tuple[Any, dict[str, Any]]:
        """Start an episode."""
        super().reset(seed=seed, options=options)
        self._draw_here()
        if seed is None:
            return self._taken(self.inner.reset()), {}
        # It draws from numpy's global generator or from its own, by its version.
        self.inner.rng.bit_generator.state = np.random.default_rng(seed).bit_generator.state
        before = np.random.get_state()  # noqa: NPY002
        np.random.seed(seed % 2**32)  # noqa: NPY002
        try:
            return self._taken(self.inner.reset()), {}
        finally:
            np.random.set_state(before)  # noqa: NPY002

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """Run one control step; its only end is the horizon."""
        self._draw_here()
        seen, reward, done, info = self.inner.step(action)
        succeeded = bool(self.inner._check_success())
        return self._taken(seen), float(reward), False, bool(done), {**info, "success": succeeded}

    def close(self) -> None:
        """Free what the simulator holds."""
        # What is freed goes by its number, in whichever context is current: another environment's
        # textures have the same ones.
        if getattr(self.inner, "sim", None) is not None:
            self._draw_here()
        self.inner.close()

    def memory(self) -> NDArray[np.float64]:
        """(m,) what grippers were told so far, and what was observed: robosuite samples early."""
        grippers = [_padded(each.current_action, len(each.actuators)) for each in self._grippers]
        seen = [np.ravel(each.obs) for each in self._observables]
        return np.concatenate([np.zeros(0), *grippers, *seen]).astype(np.float64)

    def recall(self, memory: NDArray[np.float64]) -> None:
        """Take both back; images are looked at anew."""
        self._draw_here()
        # Also those of which the loop below knows nothing, which are images.
        self.inner._obs_cache = {}
        self.inner._update_observables(force=True)
        for gripper in self._grippers:
            told, memory = np.split(memory, [1 + len(gripper.actuators)])
            gripper.current_action = told[1 : 1 + int(told[0])]
        for each in self._observables:
            seen, memory = np.split(memory, [np.size(each.obs)])
            each._current_observed_value = seen.reshape(np.shape(each.obs))
            each._time_since_last_sample, each._sampled = 0.0, False

    def _draw_here(self) -> None:
        """Have OpenGL draw for this environment.

        robosuite says so once. Where another one was made or closed since, pictures would be of
        neither, and no error.
        """
        drawing = getattr(self.inner.sim, "_render_context_offscreen", None)
        if drawing is not None:
            drawing.gl_ctx.make_current()

    def _get_obs(self) -> dict[str, NDArray]:
        self._draw_here()
        return self._taken(self.inner._get_observations())

    @property
    def _grippers(self) -> list[Any]:
        found = [gripper for robot in self.inner.robots for gripper in robot.gripper.values()]
        return [each for each in found if np.size(getattr(each, "current_action", ()))]

    @property
    def _observables(self) -> list[Any]:
        found = self.inner._observables.items()
        return [each for name, each in found if not name.endswith(IMAGE) and each.is_active()]

    def _taken(self, seen: Mapping[str, Any]) -> dict[str, NDArray]:
        return {
            key: np.ascontiguousarray(value[::-1]) if self._is_flipped(key) else np.asarray(value)
            for key, value in seen.items()
            if not key.endswith(JOINED)
        }

    def _is_flipped(self, key: str) -> bool:
        return self._flips and key.endswith(IMAGE)


def _padded(told: NDArray, size: int) -> NDArray[np.float64]:
    """(1 + size,) how many numbers a gripper was told, and these: at first they may be fewer."""
    return np.concatenate([[len(told)], told, np.zeros(size - len(told))])


def _space(key: str, value: NDArray) -> spaces.Box:
    if key.endswith(IMAGE):
        return spaces.Box(0, 255, value.shape, np.uint8)
    return spaces.Box(-np.inf, np.inf, value.shape, np.float64)
