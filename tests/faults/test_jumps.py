"""Whatever fails, the arm's commanded joints stay within their limits, and come to rest."""

from collections.abc import Iterator
from contextlib import suppress
from typing import Any

import numpy as np
import pytest

from sheath_manip.exceptions import AttemptError
from sheath_manip.gates import Mixture
from sheath_manip.rollout.loop import rollout
from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.grasp_clutter.entry import GRASP_CLUTTER, drive_of
from sheath_manip.tasks.grasp_clutter.scene import EASY
from sheath_manip.tasks.grasp_clutter.task import CONTROL_TIMESTEP_S, GraspTask, Scenario
from sheath_manip.types import (
    Actor,
    EpisodeInfo,
    Observation,
    Observations,
    Outcome,
    Proposal,
    Purpose,
)
from tests.cases import first_of
from tests.faults.parts import Faulty
from tests.faults.ways import NO_ACTIONS, NO_DECISIONS, NO_PROPOSALS, RAISING, afterwards, answering

ROUNDING = 1e-9
AT_REST_RAD_S = 0.01
"""the posture that a twist leaves open creeps on"""
TIME_LIMIT_S = 3.0
STEPS = round(TIME_LIMIT_S / CONTROL_TIMESTEP_S)


class Wild:
    """Wants another thing at full speed at each step: a policy, or an expert."""

    def __init__(self, seed: int) -> None:
        self.draws = np.random.default_rng(seed)

    def reset(self, rng: np.random.Generator | None = None) -> None:
        del rng

    def propose(self, observations: Observations) -> Proposal:
        del observations
        return Proposal(self._wish()[None])

    def act(self, observation: Observation) -> np.ndarray:
        del observation
        return self._wish()

    def _wish(self) -> np.ndarray:
        wish = self.draws.choice([-1.0, 1.0], 7).astype(np.float32)
        wish[6] = 0
        return wish


class Commands:
    """Writes down every command that the arm is given, also where its step then fails."""

    def __init__(self, environment: ComposerEnvironment, patch: pytest.MonkeyPatch) -> None:
        drive = drive_of(environment)
        self.targets: list[np.ndarray] = []
        self.velocities: list[np.ndarray] = []
        command = drive.command

        def written(action: np.ndarray) -> None:
            command(action)
            guard = drive.command_filter
            assert guard is not None
            self.targets.append(guard.targets_rad)
            self.velocities.append(guard.velocities_rad_s)

        patch.setattr(drive, "command", written)

    def check(self, environment: ComposerEnvironment) -> None:
        guard = drive_of(environment).command_filter
        assert guard is not None
        joints, stopping = guard.joints, guard.stopping
        moved = np.diff(np.array(self.targets), axis=0) / CONTROL_TIMESTEP_S
        assert (np.abs(moved) <= joints.speeds_rad_s + ROUNDING).all()
        velocities = np.array([np.zeros(len(joints.speeds_rad_s)), *self.velocities])
        changes = np.diff(velocities, axis=0)
        assert (np.abs(changes) <= stopping.most_change + ROUNDING).all()
        assert (np.abs(np.diff(changes, axis=0)) <= stopping.most_jerk + ROUNDING).all()
        # They do move, or it would be no test.
        assert np.abs(velocities).max() > 0.1


@pytest.fixture(scope="module")
def environment() -> Iterator[ComposerEnvironment]:
    # Without cameras, and short.
    task = GraspTask(Scenario(difficulty=EASY, cameras=(), time_limit_s=TIME_LIMIT_S))
    made = ComposerEnvironment(task)
    yield made
    made.close()


@pytest.mark.parametrize("seed", first_of(5, range(60)))
def test_the_command_stays_within_its_limits_whatever_fails(seed, environment, monkeypatch):
    rng = np.random.default_rng(seed)
    commands = Commands(environment, monkeypatch)

    def some(ways: dict, first: int, times: int, part: object, method: str) -> Faulty:
        way = list(ways.values())[rng.integers(len(ways))]
        return Faulty(part, method, way, first, times)

    def answers(table) -> dict:
        return {name: answering(make) for name, make in table.items()}

    def first() -> int:
        return int(rng.integers(1, STEPS // 2))

    policies = [dict(RAISING), answers(NO_PROPOSALS)][seed % 2]
    gates = [answers(NO_DECISIONS), dict(RAISING)][seed % 2]
    policy: Any = some(policies, first(), int(rng.integers(1, 20)), Wild(seed), "propose")
    gate: Any = some(gates, first(), int(rng.integers(1, 10)), Mixture(0.3), "decide")
    expert: Any = Wild(100 + seed)
    place: Any = environment
    if seed % 5 in (1, 3):
        expert = some(answers(NO_ACTIONS), first(), 99, expert, "act")
    if seed % 5 in (2, 4):
        ways = {"afterwards": afterwards} if seed % 5 == 2 else dict(RAISING)
        place = some(ways, STEPS // 2, 1, environment, "step")
    told = []
    with suppress(AttemptError):
        told.append(
            rollout(
                place,
                EpisodeInfo("grasp-clutter", seed, Purpose.LEARNING, 20.0),
                gate,
                rng=rng,
                policy=policy,
                expert=expert,
                hold=GRASP_CLUTTER.make_hold(environment),
                listeners=(Last(told),),
            )
        )
    commands.check(environment)
    episode = told[0]
    assert (episode.outcome is Outcome.ERROR) == (seed % 5 != 0)
    assert any(step.decision.broken for step in episode.steps)
    if episode.outcome is Outcome.ERROR:
        assert episode.steps[-1].decision.actor is Actor.HOLD
        assert np.abs(commands.velocities[-1]).max() < AT_REST_RAD_S


class Last:
    """Keeps the episode that it is told of."""

    def __init__(self, told: list) -> None:
        self.told = told

    def on_fit(self, states) -> None:
        del states

    def on_start(self, environment, info) -> None:
        del environment, info

    def on_step(self, environment, step) -> None:
        del environment, step

    def on_end(self, episode) -> None:
        self.told.append(episode)
