from collections.abc import Iterator

import numpy as np
import pytest

from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.platformer.expert import FOLLOWED_STEPS, PlatformerExpert
from sheath_manip.tasks.platformer.planner import ACTIONS, Planner
from sheath_manip.tasks.platformer.stage import LENGTH_TILES
from sheath_manip.tasks.platformer.task import CHOICES, PlatformerTask, Scenario
from sheath_manip.types import Outcome


@pytest.fixture(scope="module")
def task() -> PlatformerTask:
    return PlatformerTask(Scenario())


@pytest.fixture(scope="module")
def environment(task) -> Iterator[ComposerEnvironment]:
    environment = ComposerEnvironment(task)
    yield environment
    environment.close()


@pytest.fixture(scope="module")
def expert(environment) -> PlatformerExpert:
    return PlatformerExpert(environment)


def test_completes_stages(environment, expert):
    distances = []
    for seed in range(900, 906):
        observation, ended = environment.reset(seed), False
        expert.reset()
        while not ended:
            transition = environment.step(expert.act(observation))
            ended = transition.terminated or transition.truncated
        distances.append(environment.metrics()["distance_tiles"])
    assert np.mean(distances) >= 0.97 * LENGTH_TILES


def test_what_is_planned_is_what_happens_to_the_bit(environment, task):
    """Over half a stage, though the planner has a model of its own with other blocks in it."""
    planner = Planner()
    environment.reset(3)
    planner.begin(task.stage)
    for _ in range(25):
        plan = planner.plan(task.moment)
        way = planner.followed(plan, FOLLOWED_STEPS)
        assert way[0][0] == task.moment
        for moment, buttons in way:
            assert task.moment == moment
            environment.step(np.array(buttons, np.float32))
        assert environment.outcome() is not Outcome.FAILURE
        if environment.outcome() is Outcome.SUCCESS:
            break
    assert task.moment.x > LENGTH_TILES / 4


def test_plans_only_where_it_must(environment, expert, monkeypatch):
    calls = []
    plan = expert.planner.plan
    monkeypatch.setattr(expert.planner, "plan", lambda at: calls.append(at.step) or plan(at))
    observation = environment.reset(7)
    expert.reset()
    for _ in range(2 * FOLLOWED_STEPS):
        expert.act(observation)
        environment.step(expert.act(observation))
    assert calls == [0, FOLLOWED_STEPS]
    # Somebody else does something else.
    environment.step(np.array([1, 0, 0, 0], np.float32))
    expert.act(observation)
    assert calls == [0, FOLLOWED_STEPS, 2 * FOLLOWED_STEPS + 1]


def test_a_label_for_any_state(environment, expert, task):
    """Also where all is lost."""
    rng = np.random.default_rng(0)
    for seed in range(5):
        observation, ended = environment.reset(seed), False
        expert.reset()
        while not ended:
            label = expert.act(observation)
            assert tuple(label.tolist()) in [tuple(map(float, buttons)) for buttons in ACTIONS]
            drawn = CHOICES[rng.integers(len(CHOICES))]._replace(right=True, left=False)
            transition = environment.step(np.array(drawn, np.float32))
            ended = transition.terminated or task.moment.step >= 60


def test_takes_over_shortly_before_a_death(environment, expert, task):
    """From one who only runs, a second before the fall or the enemy."""
    rescued = 0
    for seed in range(12):
        observation = environment.reset(seed)
        expert.reset()
        run = np.array([0, 1, 0, 1], np.float32)
        states = []
        while task.moment.step < 200 and environment.outcome() is Outcome.TIME_LIMIT:
            states.append(environment.state())
            environment.step(run)
        if environment.outcome() is not Outcome.FAILURE or len(states) < 24:
            continue
        observation = environment.restore(states[-24])
        for _ in range(60):
            if environment.step(expert.act(observation)).terminated:
                break
        assert environment.outcome() is not Outcome.FAILURE
        rescued += 1
    assert rescued >= 3


def test_wants_a_platformer():
    class Other:
        task = object()

    with pytest.raises(TypeError, match="wants a PlatformerTask"):
        PlatformerExpert(Other())  # pyright: ignore[reportArgumentType]
