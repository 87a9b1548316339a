"""How fast the manipulation environment steps, and how far its expert comes.

    python -m tools.bench_env [--quick] [--results DIRECTORY]

writes bench-env.json, which `sheath claims` reads. Times are of the CPU; the sides of a ratio take
turns. --quick takes other sizes, to see that it runs.
"""

import multiprocessing
import time
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np
from dm_control import manipulation
from numpy.typing import NDArray

from sheath_manip.seeding import generator, scene_seed
from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.grasp_clutter.expert import GraspExpert
from sheath_manip.tasks.grasp_clutter.task import (
    CONTROL_TIMESTEP_S,
    IMAGE_PX,
    PHYSICS_TIMESTEP_S,
    GraspTask,
    Scenario,
)
from sheath_manip.tasks.rendering import PyramidCamera
from sheath_manip.types import Action, Observation, Outcome, Purpose
from tools.bench import Line, at_least, at_most, run_bench, spent_s

SEEDS = "bench"
"""of scenes that no experiment and no tuning has seen"""
CAMERAS = ("front", "wrist")
_PHYSICS_STEPS = round(CONTROL_TIMESTEP_S / PHYSICS_TIMESTEP_S)


@dataclass(frozen=True)
class Sizes:
    """How much is measured."""

    rounds: int = 9
    theirs_steps: int = 12
    scenes: int = 200
    takeovers: int = 100
    timed_scenes: int = 20


QUICK = Sizes(rounds=2, theirs_steps=3, scenes=2, takeovers=2, timed_scenes=1)


class Player:
    """An environment with its expert."""

    def __init__(self, cameras: tuple[str, ...] = ()) -> None:
        self.task = GraspTask(Scenario(cameras=cameras))
        self.environment = ComposerEnvironment(self.task)
        self.expert = GraspExpert(self.environment)

    def begin(self, number: int) -> Observation:
        """Reset to the scene of that number."""
        observation = self.environment.reset(scene_seed(Purpose.EVALUATION, SEEDS, number))
        self.expert.reset()
        return observation

    def play(self, observation: Observation, steps: int) -> tuple[list[Action], bool]:
        """What the expert did in so many steps, and whether the episode has ended."""
        actions, ended = [], False
        while len(actions) < steps and not ended:
            actions.append(self.expert.act(observation))
            transition = self.environment.step(actions[-1])
            observation = transition.observation
            ended = transition.terminated or transition.truncated
        return actions, ended


class Repeat:
    """An expert episode again, in each of the ways that are compared."""

    def __init__(self, cameras: tuple[str, ...]) -> None:
        self._player = Player(cameras)
        environment = self._player.environment
        self._actions, _ = self._player.play(self._player.begin(0), 10_000)
        self._player.begin(0)
        # Not before: composer compiles the model a second time at the first reset.
        self._model, self._data = environment.physics.model.ptr, environment.physics.data.ptr
        self._controls: list[NDArray[np.float64]] = []
        for action in self._actions:
            environment.step(action)
            self._controls.append(self._data.ctrl.copy())
        # As the task names them, on cameras of their own.
        self._cameras = [
            PyramidCamera(self._player.task.camera_name(name), IMAGE_PX, pyramid_levels=0)
            for name in cameras
        ]

    def __len__(self) -> int:
        return len(self._actions)

    def begin(self) -> None:
        """Reset to the episode's start."""
        self._player.begin(0)

    def steps(self) -> None:
        """As an environment's steps."""
        for action in self._actions:
            self._player.environment.step(action)

    def limit(self) -> None:
        """The physics, and the pictures, alone."""
        physics = self._player.environment.physics
        for control in self._controls:
            self._data.ctrl[:] = control
            mujoco.mj_step(self._model, self._data, _PHYSICS_STEPS)
            for camera in self._cameras:
                camera(physics)

    def compared(self, rounds: int) -> tuple[float, float]:
        """Median CPU seconds of a step as the limit has it, and of the environment's."""
        times: list[list[float]] = []
        for _ in range(rounds):
            row = []
            for side in (self.limit, self.steps):
                self.begin()
                row.append(spent_s(side) / len(self))
            times.append(row)
        limit, ours = np.median(times, axis=0)
        return float(limit), float(ours)


def features_lines(sizes: Sizes) -> dict[str, Line]:
    """A control step without cameras."""
    limit, ours = Repeat(()).compared(sizes.rounds)
    how = f"{1e3 * ours:.2f} ms against {1e3 * limit:.2f}, an expert episode again"
    return {"features-only step": at_most(ours / limit, 1.5, "times raw mj_step", how)}


_theirs: list[Any] = []
"""in a worker process: dm_control's environment, made by its first call"""


def theirs_s(steps: int) -> float:
    """CPU seconds of a step of lift_brick_vision as shipped."""
    if not _theirs:
        _theirs.append(manipulation.load("lift_brick_vision", seed=0))
        _theirs[0].reset()
    environment = _theirs[0]
    action = np.zeros(environment.action_spec().shape)
    return spent_s(lambda: environment.step(action), steps)


def vision_lines(sizes: Sizes) -> dict[str, Line]:
    """A control step with two cameras."""
    repeat = Repeat(CAMERAS)
    spawn = multiprocessing.get_context("spawn")
    rows = []
    # In a process of its own: two renderers in one are not to be trusted.
    with ProcessPoolExecutor(1, mp_context=spawn) as pool:
        for _ in range(sizes.rounds):
            theirs = pool.submit(theirs_s, sizes.theirs_steps).result()
            repeat.begin()
            rows.append([theirs, spent_s(repeat.steps) / len(repeat)])
    theirs, ours = np.median(rows, axis=0)
    limit, again = repeat.compared(sizes.rounds)
    both = f"{1e3 * again:.2f} ms against {1e3 * limit:.2f}, an expert episode again"
    return {
        "step with two cameras": at_least(
            theirs / ours,
            8,
            "times lift_brick_vision's",
            f"{1e3 * ours:.2f} ms against {1e3 * theirs:.1f} as shipped",
        ),
        "step with two cameras, of the limit": at_least(
            limit / again, 0.7, "of physics and pictures", both
        ),
        "step outside physics and pictures": at_most(1 - limit / again, 0.3, "of a step", both),
    }


def expert_lines(sizes: Sizes) -> dict[str, Line]:
    """What the expert costs."""
    player, spent, begun = Player(), [], []
    for number in range(sizes.timed_scenes):
        start = time.process_time()
        observation, ended = player.begin(number), False
        begun.append(time.process_time() - start)
        while not ended:
            seen = observation
            spent.append(spent_s(lambda seen=seen: player.expert.act(seen)))
            transition = player.environment.step(player.expert.act(observation))
            observation = transition.observation
            ended = transition.terminated or transition.truncated
    median, p95 = 1e3 * np.percentile(spent, [50, 95])
    how = (
        f"median {median:.2f}, {len(spent)} steps; a reset, which tells whether the scene can be "
        f"solved, takes {1e3 * float(np.median(begun)):.0f} ms"
    )
    return {"expert, 95th percentile": at_most(p95, 5, "ms a step", how)}


def solved_lines(sizes: Sizes) -> dict[str, Line]:
    """How far the expert comes on scenes that can be solved, and how many of those drawn can."""
    player, outcomes, toppled, draws = Player(), [], 0.0, 0
    for number in range(sizes.scenes):
        player.play(player.begin(number), 10_000)
        outcomes.append(player.environment.outcome() is Outcome.SUCCESS)
        toppled += player.environment.metrics()["toppled"]
        draws += player.task.draws
    how = f"{sum(outcomes)} of {len(outcomes)} hard scenes; {draws} were drawn for them"
    return {
        "expert's success": at_least(float(np.mean(outcomes)), 0.98, "of episodes", how),
        "toppled by the expert": at_most(toppled, 0, "objects", how),
    }


def takeover_lines(sizes: Sizes) -> dict[str, Line]:
    """How far it comes from where an erring driver was interrupted."""
    player, outcomes, lost, number = Player(), [], 0, 0
    while len(outcomes) < sizes.takeovers:
        number += 1
        if not _interrupted(player, number):
            lost += 1
            continue
        # The time of the other's driving does not count.
        for _ in range(2):
            _, ended = player.play(player.environment.observe(), player.environment.spec.max_steps)
            if ended and player.environment.outcome() is not Outcome.TIME_LIMIT:
                break
        outcomes.append(player.environment.outcome() is Outcome.SUCCESS)
    how = (
        f"{sum(outcomes)} of {len(outcomes)}, after 1 to 3 s of noise, of a constant error or of a "
        f"random twist; {lost} more episodes had ended by then"
    )
    return {
        "expert's success as it takes over": at_least(
            float(np.mean(outcomes)), 0.9, "of takeovers", how
        )
    }


def _interrupted(player: Player, number: int) -> bool:
    """Let an erring driver drive; whether the episode still goes on."""
    rng = generator("bench-env", "interrupted", number)
    observation = player.begin(number)
    if player.play(observation, int(rng.integers(5, 75)))[1]:
        return False
    kind = number % 3
    twist = rng.uniform(-1, 1, 7) * [0.5, 0.5, 0.5, 0.3, 0.3, 0.6, 1.0]
    error = rng.normal(0, 0.25, 7)
    for _ in range(int(rng.integers(20, 60))):
        action = player.expert.act(observation)
        if kind == 0:
            action = action + rng.normal(0, 0.8, 7)
        elif kind == 1:
            action = action + error
        else:
            action = twist + rng.normal(0, 0.2, 7)
        transition = player.environment.step(np.clip(action, -1, 1).astype(np.float32))
        observation = transition.observation
        if transition.terminated or transition.truncated:
            return False
    return True


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure, print a line a number, write the file."""
    measures = features_lines, vision_lines, expert_lines, solved_lines, takeover_lines
    run_bench("env", __doc__, measures, Sizes(), QUICK, arguments)


if __name__ == "__main__":
    main()
