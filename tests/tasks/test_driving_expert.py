import time
from collections.abc import Iterator
from itertools import product

import numpy as np
import pytest

from sheath_manip.gates import AlwaysExpert
from sheath_manip.rollout.loop import rollout
from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.driving.expert import DrivingExpert
from sheath_manip.tasks.driving.task import DrivingTask, Scenario
from sheath_manip.types import EpisodeInfo, Outcome, Purpose
from tests.cases import first_of

# What the expert knows is not in the picture, so a tiny one will do.
SCENARIO = Scenario(render_px=16, pyramid_levels=1)


@pytest.fixture(scope="module")
def task() -> DrivingTask:
    return DrivingTask(SCENARIO)


@pytest.fixture(scope="module")
def environment(task) -> Iterator[ComposerEnvironment]:
    environment = ComposerEnvironment(task)
    yield environment
    environment.close()


@pytest.fixture(scope="module")
def expert(environment) -> DrivingExpert:
    return DrivingExpert(environment)


@pytest.mark.parametrize("seed", first_of(3, range(1000, 1020)))
def test_drives_a_lap_without_a_failure(environment, expert, seed):
    info = EpisodeInfo("driving", seed, Purpose.DEMONSTRATION, 10.0)
    episode = rollout(
        environment, info, AlwaysExpert(), rng=np.random.default_rng(0), expert=expert
    )
    assert episode.outcome is Outcome.SUCCESS
    # Weaving costs little.
    assert len(episode) < 1.15 * environment.spec.max_steps / 1.5


def displaced(environment, task, s_m: float, lateral_m: float, turned_rad: float) -> None:
    environment.reset(0)
    far = np.full(task.scenario.cars, -500.0)
    task.set_traffic(environment.physics, np.stack([np.zeros_like(far), far], 1))
    pose = task.track.pose(np.array(s_m), np.array(lateral_m))
    task.place(environment.physics, pose + np.array([0.0, 0.0, turned_rad]))


@pytest.mark.parametrize(
    ("lateral_m", "turned_deg"), list(product((-3.0, 0.0, 3.0), (-45.0, 0.0, 45.0)))
)
def test_brings_a_displaced_car_back_to_the_middle(
    environment, task, expert, lateral_m, turned_deg
):
    # On a straight, before a corner, in one, and at its end.
    for s_m in (0.0, 11.0, 20.0, 27.0):
        displaced(environment, task, s_m, lateral_m, np.deg2rad(turned_deg))
        observation = environment.observe()
        for _ in range(25):
            transition = environment.step(expert.act(observation))
            observation = transition.observation
            assert not transition.terminated, f"s {s_m} m"
        x, y, heading = observation.features
        _, lateral, road = task.track.coordinates(x, y)
        assert abs(lateral) < 1.0
        assert np.cos(heading - road) > np.cos(np.deg2rad(25.0))


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_swerves_around_a_car_that_is_suddenly_near(environment, task, expert, side):
    displaced(environment, task, 0.0, 0.5 * side, 0.0)
    traffic = np.full((task.scenario.cars, 2), -500.0)
    # 6 m ahead in the same lane: 4 m to a crash at 6 m/s.
    traffic[0] = [6.0, 0.0]
    task.set_traffic(environment.physics, traffic)
    for _ in range(20):
        assert not environment.step(expert.act(environment.observe())).terminated


def test_regrets_name_the_best_and_the_cost_of_the_others(environment, task, expert):
    # At the inner edge and turned further left: only to the right is there road.
    displaced(environment, task, 0.0, 3.2, np.deg2rad(30.0))
    choices = environment.spec.action.choices
    regrets = expert.regrets()
    assert regrets.shape == (3,)
    assert regrets.min() == 0.0
    np.testing.assert_array_equal(choices[regrets.argmin()], expert.act(environment.observe()))
    assert regrets.argmin() == choices.argmin()
    assert regrets[choices.argmax()] > 1.0


def test_a_decision_takes_less_than_ten_milliseconds(environment, expert):
    observation = environment.reset(3)
    times_s = []
    for _ in range(40):
        # Of this process alone: by the clock on the wall, others' turns would count, too.
        begin = time.process_time()
        expert.act(observation)
        times_s.append(time.process_time() - begin)
    assert np.median(times_s) < 0.010


def test_wants_a_driving_task():
    class Other:
        task = None

    with pytest.raises(TypeError, match="wants a DrivingTask"):
        DrivingExpert(Other())  # pyright: ignore[reportArgumentType]
