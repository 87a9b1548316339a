"""Nobody is stuck for more than 5 s unnoticed, by the plans of the tasks in which one can be."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest

from sheath_manip.gates import AlwaysPolicy
from sheath_manip.gates.progress import Progress, ProgressGate
from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.gauze_cutting.scenario import Scenario as GauzeScenario
from sheath_manip.tasks.gauze_cutting.task import GauzeTask
from sheath_manip.tasks.grasp_clutter.scene import EASY
from sheath_manip.tasks.grasp_clutter.task import GraspTask
from sheath_manip.tasks.grasp_clutter.task import Scenario as GraspScenario
from sheath_manip.tasks.platformer.task import PlatformerTask
from sheath_manip.tasks.platformer.task import Scenario as PlatformerScenario
from sheath_manip.tasks.table import STUDIES
from sheath_manip.types import Actor, Proposal, Reason

MOST_S = 5.0
Way = Callable[[int], list[float]]
"""of a policy that gets nowhere: what it does in each step"""


@dataclass(frozen=True)
class Case:
    """A task, and how a policy is stuck in it."""

    make: Callable[[], ComposerEnvironment]
    begin_steps: int
    """that the expert drives before"""
    ways: dict[str, Way]


def planar(step: int, size: float, period: float) -> list[float]:
    angle = 2 * np.pi * step / period
    return [size * np.cos(angle), size * np.sin(angle)]


def twist(x: float = 0.0, y: float = 0.0) -> list[float]:
    return [x, y, 0.0, 0.0, 0.0, 0.0, 0.0]


CASES = {
    "grasp-clutter": Case(
        lambda: ComposerEnvironment(GraspTask(GraspScenario(difficulty=EASY, cameras=()))),
        20,
        {
            "stands still": lambda _: twist(),
            "two actions in turns": lambda step: twist(0.5 if step % 2 else -0.5),
            "in a circle": lambda step: twist(*planar(step, 0.15, 30)),
        },
    ),
    "gauze-cutting": Case(
        lambda: ComposerEnvironment(GauzeTask(GauzeScenario(cameras=()))),
        0,
        {
            "stands still": lambda _: [0.0, 0.0],
            "two actions in turns": lambda step: [0.3 if step % 2 else -0.3, 0.0],
            "in a circle": lambda step: planar(step, 0.1, 30),
        },
    ),
    "platformer": Case(
        lambda: ComposerEnvironment(PlatformerTask(PlatformerScenario(stage=0))),
        60,
        {
            "stands still": lambda _: [0.0, 0.0, 0.0, 0.0],
            "two actions in turns": lambda step: [step % 2, 1 - step % 2, 0.0, 0.0],
            "jumps on the spot": lambda step: [0.0, 0.0, float(step % 12 < 6), 0.0],
        },
    ),
}


@pytest.mark.parametrize(
    "name",
    [
        pytest.param("gauze-cutting", marks=pytest.mark.soak),
        pytest.param("grasp-clutter", marks=pytest.mark.soak),
        "platformer",
    ],
)
def test_a_policy_that_gets_nowhere_is_noticed_in_time(name: str) -> None:
    case, study = CASES[name], STUDIES[name]
    environment = case.make()
    rate_hz = environment.spec.control_rate_hz
    expert = study.task.expert(environment)
    shown = []
    for seed in (1, 2):
        seen, rows, over = environment.reset(seed), [], False
        expert.reset()
        while not over:
            rows.append(seen.features)
            transition = environment.step(expert.act(seen))
            seen, over = transition.observation, transition.terminated or transition.truncated
        shown.append(np.stack(rows))
    progress = Progress.of(shown, study.plan("full").gate.stuck_steps)
    stuck = 0
    for way, act in case.ways.items():
        gate = ProgressGate(AlwaysPolicy(), progress)
        gate.reset(np.random.default_rng(0))
        seen, noticed_s, failed = environment.reset(1), None, False
        expert.reset()
        for step in range(case.begin_steps + round(MOST_S * rate_hz)):
            begun = step - case.begin_steps
            action = expert.act(seen) if begun < 0 else np.array(act(begun), np.float32)
            decision = gate.decide(seen, Proposal(action[None]))
            if decision.actor is not Actor.POLICY:
                assert decision.reason is Reason.STUCK
                assert begun > 0, f"{way}: the expert itself was taken for stuck"
                noticed_s = begun / rate_hz
                break
            transition = environment.step(action)
            seen, failed = transition.observation, transition.terminated
            if failed:
                break
        assert failed or noticed_s is not None, way
        stuck += not failed
    # Where a sheet is ruined or a figure is hit meanwhile, nobody is stuck; else somebody was.
    assert stuck
    environment.close()
