"""A task as a gymnasium environment."""

from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from sheath_manip.adapters.task_spaces import TaskSpaces
from sheath_manip.exceptions import ParameterError
from sheath_manip.rollout.actors import Actors
from sheath_manip.rollout.cached_expert import CachedExpert
from sheath_manip.rollout.stage import Stage
from sheath_manip.seeding import scene_seed
from sheath_manip.task import Task
from sheath_manip.types import Actor, Observation, Outcome, Purpose, Transition

RGB = "rgb_array"
SCENE = "scene"
"""the option of `reset` that names a scene and leaves the generator of further ones as it is"""
SCENES = 2**32


class TaskEnv(gymnasium.Env):
    """Runs a task of this framework as gymnasium does: `to_gymnasium` makes one.

    `reset(seed=)` gives the scene of that seed, as a recording says it; without a seed `np_random`
    draws the next, of which none is among the held-out scenes that policies are judged on. The
    info says `outcome`, `success` (also as `is_success`, which others look for), `metrics` and
    `scene`. It raises ActionError for an action outside the space, and BrokenError where the
    environment breaks down.
    """

    metadata: dict[str, Any] = {"render_modes": [RGB]}  # noqa: RUF012 - as gymnasium has it

    def __init__(
        self,
        task: Task,
        variant: str = "default",
        run_seed: int = 0,
        render_mode: str | None = None,
    ) -> None:
        """Make the environment; raises UnknownNameError for a variant that there is not.

        Args:
            task: to be run.
            variant: of the task.
            run_seed: of the training run, for variants in which each has a scene of its own.
            render_mode: `rgb_array`, or None; ParameterError for another, and where neither task
                nor camera has a picture.
        """
        if render_mode not in (None, RGB):
            raise ParameterError(f"render_mode is {render_mode!r}; wanted None or {RGB!r}")
        if task.require is not None:
            task.require()
        self.task = task
        self.variant = variant
        self.render_mode = render_mode
        self.environment = task.make_for_run(variant, run_seed)
        self.task_spec = self.environment.spec
        self.spaces = TaskSpaces.of(self.task_spec)
        self.action_space = self.spaces.action
        self.observation_space = self.spaces.observation
        self.metadata = {**self.metadata, "render_fps": self.task_spec.control_rate_hz}
        if render_mode and task.picture is None and not self.task_spec.cameras:
            self.environment.close()
            raise ParameterError(
                f"{task.name} has neither a picture nor a camera; wanted render_mode=None"
            )
        self.transition: Transition | None = None
        """what the last action led to; None before the first of an episode"""
        self._present: Observation | None = None
        self._stage = Stage(self.environment)
        self._scene = 0
        self._closed = False
        self._asked: Actors | None = None

    @property
    def present(self) -> Observation:
        """What is seen now; raises ParameterError before the first `reset`."""
        if self._present is None:
            raise ParameterError("no episode is under way; wanted reset() first")
        return self._present

    def draw_scene(self) -> int:
        """Return the seed of the next scene, drawn from `np_random`."""
        return scene_seed(Purpose.LEARNING, "gymnasium", int(self.np_random.integers(2**62)))

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Start an episode; `options={"scene": SEED}` names its scene and seeds nothing else."""
        super().reset(seed=seed)
        named = (options or {}).get(SCENE, seed)
        self._scene = self.draw_scene() if named is None else int(named)
        if not 0 <= self._scene < SCENES:
            raise ParameterError(f"the seed is {self._scene}; wanted 0 .. {SCENES - 1}")
        self._present, self.transition = None, None
        self._present = self._stage.reset(self._scene)
        if self._asked is not None:
            self._asked.reset()
            self._asked.follow(self._present)
        return self.spaces.seen(self._present), self._info()

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """Run one control step; raises ParameterError where no episode is under way."""
        done = self.transition is not None and (
            self.transition.terminated or self.transition.truncated
        )
        if self._present is None or done:
            raise ParameterError("no episode is under way; wanted reset() first")
        transition = self._stage.step(self.spaces.taken(action))
        self._present, self.transition = transition.observation, transition
        if self._asked is not None:
            self._asked.follow(self._present)
        return (
            self.spaces.seen(self._present),
            transition.reward,
            transition.terminated,
            transition.truncated,
            self._info(),
        )

    def expert(self) -> Any:
        """Return what the task's own expert would do now, as an action of the space.

        It is made when it is first asked. Raises BrokenError where it has no answer.
        """
        present = self.present
        if self._asked is None:
            expert = CachedExpert(self.task.make_expert(self.environment))
            self._asked = Actors({Actor.EXPERT: expert}, None, self.task_spec.action)
            self._asked.reset()
            self._asked.follow(present)
        return self.spaces.shown(self._asked.label(present))

    def render(self) -> NDArray[np.uint8] | None:  # pyright: ignore[reportIncompatibleMethodOverride]
        """(h, w, 3) RGB as the task's films show it, or the first camera's; None in no mode."""
        if self.render_mode is None:
            return None
        present = self.present
        if self.task.picture is not None:
            return self.task.picture(self.environment)
        return next(iter(present.images.values())).copy()

    def close(self) -> None:
        """Free the simulator; nothing happens where it is free already."""
        if not self._closed:
            self._closed = True
            self.environment.close()

    def _info(self) -> dict[str, Any]:
        outcome = Outcome(self._stage.outcome())
        success = outcome is Outcome.SUCCESS
        return {
            "outcome": str(outcome),
            "success": success,
            "is_success": success,
            "metrics": dict(self._stage.metrics()),
            SCENE: self._scene,
        }
