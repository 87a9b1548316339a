"""A toy task without a simulator: keep to the middle of a windy corridor, seen from above."""

from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from sheath_manip.cli.session import Catalog
from sheath_manip.controllers.hold import Hold
from sheath_manip.controllers.teleop.buttons import Button, ButtonHands
from sheath_manip.experiments.probes import Displacement, Probes
from sheath_manip.experiments.study import Study
from sheath_manip.learning.config import LearningPlan
from sheath_manip.task import Task
from sheath_manip.types import (
    Action,
    ActionSpec,
    Observation,
    Outcome,
    SceneGeom,
    ScenePose,
    TaskSpec,
    Transition,
)

CHOICES = np.array([[-0.3], [0.0], [0.3]], np.float32)
ACTION = ActionSpec(("sidestep_m",), CHOICES[0], CHOICES[-1], CHOICES)
HALF_WIDTH_M = 1.0
SIDE_PX = 64


class Corridor:
    """Each step goes one metre on and a gust aside; the wall is failure, the end success."""

    def __init__(self, steps: int = 12) -> None:
        self.spec = TaskSpec(
            name="corridor",
            control_rate_hz=50.0,
            action=ACTION,
            cameras={"above": (SIDE_PX, SIDE_PX)},
            feature_names=("x_m", "y_m"),
            max_steps=steps + 1,
            metric="progress",
            plane=("x_m", "y_m"),
        )
        self.steps = steps
        self.side_m = 0.0
        self.done = 0
        self._gusts_m = np.zeros(steps)

    def reset(self, seed: int) -> Observation:
        rng = np.random.default_rng(seed)
        self.side_m = float(rng.uniform(-0.3, 0.3))
        self._gusts_m = rng.uniform(-0.2, 0.2, self.steps)
        self.done = 0
        return self._observation()

    def step(self, action: Action) -> Transition:
        self.side_m += float(action[0]) + float(self._gusts_m[self.done])
        self.done += 1
        terminated = self.outcome() is not Outcome.TIME_LIMIT
        return Transition(self._observation(), 1.0, terminated, truncated=False)

    def outcome(self) -> Outcome:
        if abs(self.side_m) > HALF_WIDTH_M:
            return Outcome.FAILURE
        return Outcome.SUCCESS if self.done >= self.steps else Outcome.TIME_LIMIT

    def metrics(self) -> Mapping[str, float]:
        return {"progress": self.done / self.steps}

    def state(self) -> NDArray[np.float64]:
        return np.array([self.done, self.side_m])

    def restore(self, state: NDArray[np.float64]) -> Observation:
        self.done, self.side_m = int(state[0]), float(state[1])
        return self._observation()

    def scene(self) -> Sequence[SceneGeom]:
        size, place = np.full(3, 0.1), np.zeros(3)
        upright = np.array([1.0, 0.0, 0.0, 0.0])
        return [SceneGeom(0, "box", size, (1.0, 0.0, 0.0, 1.0), place, upright)]

    def pose(self) -> ScenePose:
        return ScenePose(np.array([[self.side_m, self.done, 0.0, 1.0, 0.0, 0.0, 0.0]]))

    def pose_at(self, state: NDArray[np.float64]) -> ScenePose:
        self.restore(state)
        return self.pose()

    def close(self) -> None:
        pass

    def _observation(self) -> Observation:
        image = np.full((SIDE_PX, SIDE_PX, 3), 100, np.uint8)
        column = round((self.side_m / HALF_WIDTH_M + 1) / 2 * (SIDE_PX - 1))
        image[:, max(column - 5, 0) : column + 5] = (220, 30, 30)
        features = np.array([self.side_m, self.done], np.float32)
        return Observation({"above": image}, features, self.done / 50.0)


class MiddleKeeper:
    """Steps towards the middle where it is far from it."""

    def __init__(self, environment: Corridor) -> None:
        self.environment = environment

    def reset(self) -> None:
        pass

    def act(self, observation: Observation) -> Action:
        del observation
        side_m = self.environment.side_m
        return CHOICES[1] if abs(side_m) < 0.15 else CHOICES[0 if side_m > 0 else 2]


def hold(environment: Corridor) -> Hold:
    del environment
    return Hold(lambda: CHOICES[1])


def corridor_action(pressed: frozenset[str]) -> Action:
    return CHOICES[1 + ("right" in pressed) - ("left" in pressed)]


def teleop(environment: Corridor) -> ButtonHands:
    del environment
    buttons = {
        "left": Button("KeyJ", "left", stick=-1),
        "right": Button("KeyL", "right", stick=1),
        "straight": Button("KeyK", "straight on"),
    }
    return ButtonHands(buttons, corridor_action)


def make_long() -> Corridor:
    return Corridor(steps=24)


def aside(side_m: float, environment: Corridor, rng: np.random.Generator) -> Observation:
    state = environment.state()
    state[1] = rng.choice([-1.0, 1.0]) * side_m
    return environment.restore(state)


def regret_m(expert: MiddleKeeper, action: Action) -> float:
    """How much farther from the middle than with the best step."""
    left_m = abs(expert.environment.side_m + CHOICES[:, 0])
    return float(abs(expert.environment.side_m + action[0]) - left_m.min())


PROBES = Probes(
    displacements=(
        Displacement("aside 0.4 m", partial(aside, 0.4), far=False),
        Displacement("aside 0.9 m", partial(aside, 0.9)),
    ),
    regret=regret_m,
    costly_regret=0.2,
)
PLAN = LearningPlan().changed(
    comparison={"seeds": (0,), "evaluation_episodes": 2, "final_episodes": 2},
    schedule={
        "demonstrations": 4,
        "calibration": 3,
        "false_alarm_episodes": 3,
        "rounds": 2,
        "episodes": 2,
    },
)
CORRIDOR = Task(
    name="corridor",
    summary="keep to the middle of a windy corridor",
    variants={"default": Corridor, "final": make_long},
    expert=MiddleKeeper,
    teleop=teleop,
    fallbacks={"hold": hold},
)
STUDY = Study(CORRIDOR, plans={"full": PLAN, "quick": PLAN}, probes=PROBES)
CATALOG = Catalog({"corridor": CORRIDOR}, {"corridor": STUDY})
