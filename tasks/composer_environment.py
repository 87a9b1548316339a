"""One adapter for all tasks, from dm_control's composer to the core's `Environment`."""

from abc import abstractmethod
from collections import OrderedDict
from collections.abc import Mapping, Sequence
from typing import cast

import mujoco
import numpy as np
from dm_control import composer, mjcf
from numpy.typing import NDArray

from sheath_manip.adapters.mujoco_scene import scene_geoms
from sheath_manip.types import (
    Action,
    CameraPose,
    Commanded,
    Line,
    Observation,
    Outcome,
    SceneGeom,
    ScenePose,
    Surface,
    TaskSpec,
    Transition,
)

_STATE = (
    mujoco.mjtState.mjSTATE_TIME
    | mujoco.mjtState.mjSTATE_QPOS
    | mujoco.mjtState.mjSTATE_QVEL
    | mujoco.mjtState.mjSTATE_ACT
    | mujoco.mjtState.mjSTATE_MOCAP_POS
    | mujoco.mjtState.mjSTATE_MOCAP_QUAT
    | mujoco.mjtState.mjSTATE_WARMSTART
)


class SheathTask(composer.Task):
    """A composer task with what it adds to be learned under a gate.

    Of its `task_observables` those that are enabled are seen. Those named after a camera of its
    `spec` are images; all others are joined, in order, to the features.
    """

    spec: TaskSpec
    legacy_step: bool = True
    """composer's own: kinematics and contacts are up to date after each physics substep, at the
    price of half of another one"""

    @property
    def observables(self) -> OrderedDict:
        """None, for composer: its buffers and delays cost more than a look at the features does."""
        return OrderedDict()

    @abstractmethod
    def outcome(self) -> Outcome:
        """SUCCESS or FAILURE once it is decided, TIME_LIMIT until then."""

    @abstractmethod
    def metrics(self) -> Mapping[str, float]:
        """The episode's figures so far."""

    @abstractmethod
    def memory(self) -> NDArray[np.float64]:
        """(m,) what the task remembers beside MuJoCo's state."""

    @abstractmethod
    def recall(self, memory: NDArray[np.float64]) -> None:
        """Take over a `memory()`."""

    def tool_m(self, physics: mjcf.Physics) -> NDArray[np.float64] | None:  # noqa: ARG002
        """(3,) the point in the world whose path viewers draw; None where there is none."""
        return None

    def camera_name(self, name: str) -> str:
        """Return the model's name of the camera that observations call `name`."""
        return name

    def surfaces(self, physics: mjcf.Physics) -> tuple[Surface, ...]:  # noqa: ARG002
        """Return what deforms, as it is now; always as many surfaces."""
        return ()

    def lines(self, physics: mjcf.Physics) -> tuple[Line, ...]:  # noqa: ARG002
        """Return what viewers draw into the scene; always as many lines."""
        return ()

    def commanded(self) -> Commanded | None:
        """Return what became of the last action; None where no command filter lies in its way."""
        return None

    # The library's own type says that it always returns False.
    def should_terminate_episode(  # pyright: ignore[reportIncompatibleMethodOverride]
        self,
        physics,  # noqa: ARG002
    ) -> bool:
        """End once the outcome is decided."""
        return self.outcome() is not Outcome.TIME_LIMIT

    def get_discount(self, physics) -> float:  # noqa: ARG002
        """0 at an end of the task's own; the time limit keeps 1 (dm_env's convention)."""
        return 1.0 if self.outcome() is Outcome.TIME_LIMIT else 0.0


class ComposerEnvironment:
    """Runs a `SheathTask` by seed. The model is compiled once, so reset must only move things."""

    def __init__(self, task: SheathTask) -> None:
        self.task = task
        self._environment = composer.Environment(
            task,
            random_state=0,
            recompile_mjcf_every_episode=False,
            legacy_step=task.legacy_step,
        )
        self._steps = 0
        self._camera_ids: dict[str, int] | None = None

    @property
    def spec(self) -> TaskSpec:
        """The task's constant description."""
        return self.task.spec

    @property
    def physics(self) -> mjcf.Physics:
        """The composer physics, for experts."""
        return cast(mjcf.Physics, self._environment.physics)

    def reset(self, seed: int) -> Observation:
        """Start the episode that belongs to `seed` (0 .. 2**32 - 1)."""
        self._environment.random_state.seed(seed)
        self._steps = 0
        self._environment.reset()
        return self.observe()

    def step(self, action: Action) -> Transition:
        """Run one control step; raises ActionError for an action outside the spec."""
        time_step = self._environment.step(self.spec.action.validated(action))
        self._steps += 1
        terminated = time_step.last()
        return Transition(
            self.observe(),
            float(time_step.reward or 0.0),
            terminated=terminated,
            truncated=not terminated and self._steps >= self.spec.max_steps,
            commanded=self.task.commanded(),
        )

    def outcome(self) -> Outcome:
        """Return how the episode stands."""
        return self.task.outcome()

    def metrics(self) -> Mapping[str, float]:
        """The episode's figures so far."""
        return self.task.metrics()

    def state(self) -> NDArray[np.float64]:
        """(s,) step count, the task's memory, MuJoCo's state."""
        model, data = self.physics.model.ptr, self.physics.data.ptr
        simulator = np.empty(mujoco.mj_stateSize(model, _STATE))
        mujoco.mj_getState(model, data, simulator, _STATE)
        return np.concatenate([[self._steps], self.task.memory(), simulator])

    def restore(self, state: NDArray[np.float64]) -> Observation:
        """Continue from a `state()`; bit-exact from there on."""
        self._take(state)
        return self.observe()

    def pose_at(self, state: NDArray[np.float64]) -> ScenePose:
        """Return how the scene stood in `state`, at which the episode then stands."""
        self._take(state)
        return self.pose()

    def observe(self) -> Observation:
        """Look at the present state."""
        physics, cameras = self.physics, self.spec.cameras
        images, features = {}, []
        for name, observable in self.task.task_observables.items():
            if not observable.enabled:
                continue
            value = observable(physics)
            if name in cameras:
                images[name] = value
            else:
                features.append(np.ravel(value))
        return Observation(
            images, np.concatenate(features).astype(np.float32), float(physics.data.ptr.time)
        )

    def scene(self) -> Sequence[SceneGeom]:
        """The visible shapes."""
        return scene_geoms(self.physics.model.ptr)

    def pose(self) -> ScenePose:
        """Return how the scene stands now."""
        physics = self.physics
        data = physics.data.ptr
        # Pairs within their margin are listed, too, before they touch.
        touching = data.contact.dist <= 0
        return ScenePose(
            np.concatenate([data.xpos, data.xquat], axis=1),
            self.task.tool_m(physics),
            data.contact.pos[touching],
            self.task.surfaces(physics),
            self.task.lines(physics),
            self._cameras(),
        )

    def close(self) -> None:
        """Free physics and renderer."""
        self._environment.close()

    def _cameras(self) -> dict[str, CameraPose]:
        model, data = self.physics.model.ptr, self.physics.data.ptr
        if self._camera_ids is None:
            kind, perspective = (
                mujoco.mjtObj.mjOBJ_CAMERA,
                mujoco.mjtProjection.mjPROJ_PERSPECTIVE,
            )
            found = {
                name: mujoco.mj_name2id(model, kind, self.task.camera_name(name))
                for name in self.spec.cameras
            }
            self._camera_ids = {
                name: camera
                for name, camera in found.items()
                if camera >= 0 and model.cam_projection[camera] == perspective
            }
        poses = {}
        for name, camera in self._camera_ids.items():
            # MuJoCo's cameras look along -z, and up is y.
            turn = data.cam_xmat[camera].reshape(3, 3) * [1.0, -1.0, -1.0]
            wxyz = np.empty(4)
            mujoco.mju_mat2Quat(wxyz, turn.ravel())
            fov_rad = float(np.deg2rad(model.cam_fovy[camera]))
            poses[name] = CameraPose(data.cam_xpos[camera].copy(), wxyz, fov_rad)
        return poses

    def _take(self, state: NDArray[np.float64]) -> None:
        model, data = self.physics.model.ptr, self.physics.data.ptr
        simulator = state[-mujoco.mj_stateSize(model, _STATE) :]
        self._steps = int(state[0])
        mujoco.mj_setState(model, data, simulator, _STATE)
        self.task.recall(state[1 : len(state) - len(simulator)])
        # After an episode's end composer would take the next step for the start of another one.
        self._environment._reset_next_step = False
        self.physics.forward()
