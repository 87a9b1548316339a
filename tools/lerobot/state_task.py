"""The grasp in clutter without cameras: what the physics knows of the objects is in the features.

A policy learns it in minutes on a CPU, and no picture is drawn.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.grasp_clutter.entry import make
from sheath_manip.tasks.grasp_clutter.scene import EASY, MEDIUM, Difficulty
from sheath_manip.tasks.grasp_clutter.task import GraspTask, Scenario
from sheath_manip.types import (
    Action,
    Observation,
    Outcome,
    SceneGeom,
    ScenePose,
    TaskSpec,
    Transition,
)

DIFFICULTIES = {"easy": EASY, "medium": MEDIUM}
NEAREST = 4
"""objects of the clutter that are told of: those nearest to the target"""
_TARGET = (
    *(f"target_from_tool_{axis}_m" for axis in "xyz"),
    *(f"target_lean_{axis}" for axis in "xy"),
    "target_radius_m",
    "target_height_m",
)
_OBJECT = ("from_tool_x_m", "from_tool_y_m", "reach_m", "height_m")
SEEN_NAMES = (*_TARGET, *(f"object_{n}_{name}" for n in range(NEAREST) for name in _OBJECT))


class StateEnvironment:
    """A grasp whose features are the robot's, and after them `SEEN_NAMES`."""

    def __init__(self, difficulty: Difficulty) -> None:
        self.inner: ComposerEnvironment = make(Scenario(difficulty=difficulty, cameras=()))
        spec = self.inner.spec
        self.robot_names = spec.feature_names
        self.spec: TaskSpec = replace(
            spec,
            name="grasp-clutter-state",
            feature_names=(*spec.feature_names, *SEEN_NAMES),
            mirror=None,
        )

    @property
    def task(self) -> GraspTask:
        """The task within."""
        assert isinstance(self.inner.task, GraspTask)
        return self.inner.task

    def reset(self, seed: int) -> Observation:
        """Start the episode that belongs to `seed`."""
        return self._seen(self.inner.reset(seed))

    def step(self, action: Action) -> Transition:
        """Run one control step."""
        transition = self.inner.step(action)
        return replace(transition, observation=self._seen(transition.observation))

    def outcome(self) -> Outcome:
        """Return how the episode stands."""
        return self.inner.outcome()

    def metrics(self) -> Mapping[str, float]:
        """The episode's figures so far."""
        return self.inner.metrics()

    def state(self) -> NDArray[np.float64]:
        """(s,) the whole simulator state."""
        return self.inner.state()

    def restore(self, state: NDArray[np.float64]) -> Observation:
        """Continue from a `state()`."""
        return self._seen(self.inner.restore(state))

    def scene(self) -> Sequence[SceneGeom]:
        """The visible shapes."""
        return self.inner.scene()

    def pose(self) -> ScenePose:
        """Return how the scene stands now."""
        return self.inner.pose()

    def pose_at(self, state: NDArray[np.float64]) -> ScenePose:
        """Return how the scene stood in `state`."""
        return self.inner.pose_at(state)

    def close(self) -> None:
        """Free the physics."""
        self.inner.close()

    def _seen(self, observation: Observation) -> Observation:
        features = np.concatenate([observation.features, self._objects()])
        return replace(observation, features=features.astype(np.float32))

    def _objects(self) -> NDArray[np.float64]:
        """(len(SEEN_NAMES),)."""
        physics, objects = self.inner.physics, self.task.scene.objects
        situation, tool = self.task.situation(physics), self.task.tool_m(physics)
        places = situation.positions_m
        target = objects[0]
        seen = [
            *(places[0] - tool),
            *situation.rotations[0, :2, 2],
            target.half_x_m,
            target.height_m,
        ]
        away = np.linalg.norm(places[1:, :2] - places[0, :2], axis=1)
        for place in 1 + np.argsort(away, kind="stable")[:NEAREST]:
            one = objects[place]
            seen += [*(places[place] - tool)[:2], one.reach_m, one.height_m]
        return np.array(seen)
