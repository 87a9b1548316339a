"""A gymnasium environment as a task: `from_gymnasium("FetchReach-v4", expert=reach)`."""

import sys
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from sheath_manip.adapters.judging import Judging, by_info
from sheath_manip.adapters.memory import Load, OwnMemory, Save
from sheath_manip.dataset.extras import needs
from sheath_manip.exceptions import ParameterError
from sheath_manip.task import HOLD, Task
from sheath_manip.types import FirstView, TaskSpec

with needs("gymnasium", "gymnasium"):
    import gymnasium

    from sheath_manip.adapters.action_space import ActionLayout
    from sheath_manip.adapters.gymnasium_environment import GymnasiumEnvironment, Terms
    from sheath_manip.adapters.gymnasium_expert import GymnasiumExpert, Rest
    from sheath_manip.adapters.observation_space import ObservationLayout
    from sheath_manip.adapters.restorable_gymnasium import RestorableGymnasium

Make = str | Callable[[], gymnasium.Env]


@dataclass(frozen=True)
class Adapted:
    """Makes the environment and says what of it is taken, and how; can be pickled where `make` can.

    `from_gymnasium` says what each setting means.
    """

    make: Make
    name: str
    settings: Mapping[str, Any] = field(default_factory=dict)
    judge: Judging = by_info
    success_steps: int = 1
    metric: str = "success"
    control_rate_hz: float | None = None
    max_steps: int | None = None
    leave_out: Collection[str] = ()
    feature_names: Mapping[str, Sequence[str]] = field(default_factory=dict)
    action_names: Sequence[str] | None = None
    bounds: tuple[ArrayLike, ArrayLike] | None = None
    tolerance: float = 0.1
    render: str = ""
    memory: tuple[Save, Load] | None = None
    tool: str = ""
    first_view: FirstView | None = None

    def __call__(self) -> GymnasiumEnvironment:
        """Make the environment; raises ParameterError where it cannot be taken."""
        gym = self._made()
        try:
            terms = self._terms(gym)
        except ParameterError as error:
            gym.close()
            raise ParameterError(f"{self.name}: {error}") from error
        if self.memory is not None:
            return RestorableGymnasium(gym, terms, OwnMemory(gym.unwrapped, *self.memory))
        # Where the environment has it, it is there.
        if "mujoco" in sys.modules and hasattr(gym.unwrapped, "_get_obs"):
            from sheath_manip.adapters.mujoco_gymnasium import MujocoGymnasium
            from sheath_manip.adapters.mujoco_simulation import MujocoSimulation

            if MujocoSimulation.is_behind(gym.unwrapped):
                return MujocoGymnasium(gym, terms, self.tool)
        return GymnasiumEnvironment(gym, terms)

    def _made(self) -> gymnasium.Env:
        settings = dict(self.settings)
        if not isinstance(self.make, str):
            return self.make(**settings)
        if self.render:
            settings.setdefault("render_mode", "rgb_array")
        try:
            return gymnasium.make(self.make, disable_env_checker=True, **settings)
        except (gymnasium.error.Error, ModuleNotFoundError) as error:
            raise ParameterError(
                f"gymnasium cannot make {self.make!r} ({error}); where a package registers it, "
                "write PACKAGE:ID, such as gymnasium_robotics:FetchPickAndPlace-v4"
            ) from error

    def _terms(self, gym: gymnasium.Env) -> Terms:
        space, names = gym.observation_space, self.feature_names
        observations = ObservationLayout.of(space, names, self.leave_out)
        actions = ActionLayout.of(gym.action_space, self.action_names, self.bounds, self.tolerance)
        cameras = dict(observations.cameras)
        if self.render:
            cameras[self.render] = _rendered_size(gym)
        spec = TaskSpec(
            name=self.name,
            control_rate_hz=self.control_rate_hz or _control_rate_hz(gym),
            action=actions.spec,
            cameras=cameras,
            feature_names=observations.feature_names,
            max_steps=self.max_steps or _max_steps(gym),
            metric=self.metric,
            first_view=self.first_view,
        )
        return Terms(spec, observations, actions, self.judge, self.success_steps, self.render)


def from_gymnasium(
    make: Make,
    *,
    expert: Callable[[Any], Any] | None = None,
    judge: Judging = by_info,
    name: str = "",
    summary: str = "",
    settings: Mapping[str, Any] | None = None,
    success_steps: int = 1,
    metric: str = "success",
    control_rate_hz: float | None = None,
    max_steps: int | None = None,
    leave_out: Collection[str] = (),
    feature_names: Mapping[str, Sequence[str]] | None = None,
    action_names: Sequence[str] | None = None,
    bounds: tuple[ArrayLike, ArrayLike] | None = None,
    tolerance: float = 0.1,
    render: str = "",
    rest: ArrayLike | None = None,
    memory: tuple[Save, Load] | None = None,
    tool: str = "",
    first_view: FirstView | None = None,
) -> Task:
    """Return a gymnasium environment as a task, which can be pickled where its parts can.

    The environment is made later, once for each process that runs it, and what cannot be taken of
    it is said then.

    Args:
        make: its id, `PACKAGE:ID` where a package registers it, or what makes it.
        expert: from an observation of gymnasium's to an action, or a class of such: called with the
            unwrapped environment, with `act(observation)` and, where it remembers, `reset()`.
        judge: how the episode stands after a step; by default the info's `is_success` or `success`
            says so, and an end of the environment's own without it is a failure.
        name: of the task; by default the id in small letters.
        summary: of the task, for tables.
        settings: keywords that the environment is made with.
        success_steps: steps in a row that must be judged a success for the episode to end as one.
        metric: by which episodes are judged: `success`, or `return`, the sum of rewards.
        control_rate_hz: by default the environment's `dt`, or `render_fps` in its metadata.
        max_steps: time limit; by default the one that the environment is registered with.
        leave_out: keys of the observation that nobody is to see.
        feature_names: of features, by key; KEY_0, KEY_1 and so on by default.
        action_names: of the action's dimensions.
        bounds: the least and the greatest action of a space that has none.
        tolerance: share of its range by which each number of two continuous actions may differ and
            they still count as the same.
        render: name of a camera that shows what the environment renders as `rgb_array`.
        rest: the action that leaves the robot where it is, where there is one.
        memory: two functions, to save what the unwrapped environment remembers, as (s,) numbers,
            and to load it, which returns the observation there; not wanted for MuJoCo.
        tool: MuJoCo site or body whose way viewers draw.
        first_view: how viewers look at that.

    Raises ParameterError where a task without an id has no name.
    """
    if not (name or isinstance(make, str)):
        raise ParameterError("an environment that is not made by its id wants a name=")
    name = name or str(make).rpartition(":")[2].replace("/", "-").lower()
    adapted = Adapted(
        make,
        name,
        settings or {},
        judge,
        success_steps,
        metric,
        control_rate_hz,
        max_steps,
        leave_out,
        feature_names or {},
        action_names,
        bounds,
        tolerance,
        render,
        memory,
        tool,
        first_view,
    )
    return Task(
        name=name,
        summary=summary or f"{make if isinstance(make, str) else name}, of gymnasium",
        # Every seed is a new scene, so that the default's are new ones as well.
        variants={"default": adapted, "final": adapted},
        expert=partial(GymnasiumExpert, expert),
        fallbacks={} if rest is None else {HOLD: partial(Rest, np.asarray(rest, np.float32))},
    )


def _control_rate_hz(gym: gymnasium.Env) -> float:
    dt_s = getattr(gym.unwrapped, "dt", None)
    rate_hz = 1 / dt_s if dt_s else gym.metadata.get("render_fps")
    if not rate_hz:
        raise ParameterError("it has no dt and no render_fps; wanted control_rate_hz=")
    return float(rate_hz)


def _max_steps(gym: gymnasium.Env) -> int:
    registered = gym.spec and gym.spec.max_episode_steps
    limit = registered or getattr(gym.unwrapped, "max_episode_steps", None)
    if not limit:
        raise ParameterError("it is registered without max_episode_steps; wanted max_steps=")
    return limit


def _rendered_size(gym: gymnasium.Env) -> tuple[int, int]:
    gym.reset(seed=0)
    picture: Any = gym.render()
    if not isinstance(picture, np.ndarray) or picture.shape[2:] != (3,):
        raise ParameterError(
            f"it renders {type(picture).__name__}; wanted (h, w, 3) uint8, as render_mode="
            "'rgb_array' gives"
        )
    return picture.shape[:2]
