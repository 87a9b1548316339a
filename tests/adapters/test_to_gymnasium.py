"""Tasks as gymnasium environments."""

from dataclasses import replace

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from sheath_manip.adapters.task_env import TaskEnv
from sheath_manip.adapters.to_gymnasium import HOUSE, to_gymnasium
from sheath_manip.exceptions import ActionError, ParameterError, UnknownNameError
from sheath_manip.tasks.table import TASKS
from sheath_manip.types import Purpose
from tests.guest_package.guest.slide import SLIDE
from tests.toy import CORRIDOR, Corridor, MiddleKeeper

# Features have no bounds, as those of gymnasium's own MuJoCo environments.
UNBOUNDED = pytest.mark.filterwarnings("ignore:.*infinity:UserWarning")


def test_every_task_of_the_house_has_an_id():
    assert set(HOUSE) == set(TASKS.own)


@UNBOUNDED
@pytest.mark.parametrize("name", HOUSE)
def test_gymnasium_finds_nothing_to_complain_of(name):
    env = gymnasium.make(f"sheath_manip.adapters.to_gymnasium:sheath/{name}-v0")
    check_env(env.unwrapped)
    env.close()


@UNBOUNDED
@pytest.mark.parametrize("task", [CORRIDOR, SLIDE], ids=["images and choices", "features alone"])
def test_nor_with_a_task_of_ones_own(task):
    check_env(to_gymnasium(task), skip_render_check=task is SLIDE)


def test_spaces_are_what_the_task_shows_and_takes():
    env = to_gymnasium(CORRIDOR)
    assert isinstance(env.observation_space, gymnasium.spaces.Dict)
    seen = env.observation_space.spaces
    assert (seen["above"].shape, seen["above"].dtype) == ((64, 64, 3), np.uint8)
    assert seen["features"].shape == (2,)
    assert env.action_space == gymnasium.spaces.Discrete(3)
    alone = to_gymnasium(SLIDE)
    assert isinstance(alone.observation_space, gymnasium.spaces.Box)
    assert isinstance(alone.action_space, gymnasium.spaces.Box)


def test_the_seed_is_the_scenes_and_the_same_actions_give_the_same_episode():
    env, environment = to_gymnasium(CORRIDOR), Corridor()
    seen, info = env.reset(seed=7)
    wanted = environment.reset(7)
    assert info == {
        "outcome": "time-limit",
        "success": False,
        "is_success": False,
        "metrics": {"progress": 0.0},
        "scene": 7,
    }
    reward, terminated, truncated = 0.0, False, False
    for _ in range(12):
        assert np.array_equal(seen["features"], wanted.features)
        assert np.array_equal(seen["above"], wanted.images["above"])
        choice = env.expert()
        wanted = environment.step(env.spaces.taken(choice)).observation
        seen, reward, terminated, truncated, info = env.step(choice)
    assert (reward, terminated, truncated) == (1.0, True, False)
    assert (info["outcome"], info["success"], info["metrics"]) == ("success", True, {"progress": 1})


def test_without_a_seed_scenes_are_drawn_apart_from_those_that_policies_are_judged_on():
    def scenes(seed: int) -> list[int]:
        env = to_gymnasium(CORRIDOR)
        env.reset(seed=seed)
        return [env.reset()[1]["scene"] for _ in range(4)]

    assert scenes(3) == scenes(3)
    assert len({*scenes(3), *scenes(4)}) == 8
    own = list(Purpose).index(Purpose.LEARNING)
    assert {scene >> 30 for scene in scenes(3)} == {own}


def test_an_option_names_the_scene_and_leaves_the_generator_alone():
    env, other = to_gymnasium(CORRIDOR), to_gymnasium(CORRIDOR)
    for each in (env, other):
        each.reset(seed=1)
    assert env.reset(options={"scene": 5})[1]["scene"] == 5
    assert env.reset()[1]["scene"] == other.reset()[1]["scene"]


def test_it_is_driven_by_the_variant_that_is_asked_for():
    env = to_gymnasium(CORRIDOR, "final")
    assert isinstance(env.environment, Corridor)
    assert env.environment.steps == 24
    with pytest.raises(UnknownNameError, match="unknown variant of corridor 'icy'"):
        to_gymnasium(CORRIDOR, "icy")


def test_pictures_are_the_tasks_or_the_first_cameras():
    env = to_gymnasium(CORRIDOR, render_mode="rgb_array")
    seen, _ = env.reset(seed=0)
    assert (env.render() == seen["above"]).all()
    drawn = replace(CORRIDOR, picture=lambda corridor: np.full((4, 6, 3), corridor.done, np.uint8))
    env = to_gymnasium(drawn, render_mode="rgb_array")
    env.reset(seed=0)
    env.step(1)
    assert (env.render() == np.ones((4, 6, 3), np.uint8)).all()
    assert to_gymnasium(CORRIDOR).render() is None
    with pytest.raises(ParameterError, match="neither a picture nor a camera"):
        to_gymnasium(SLIDE, render_mode="rgb_array")
    with pytest.raises(ParameterError, match="render_mode is 'human'; wanted None or 'rgb_array'"):
        to_gymnasium(CORRIDOR, render_mode="human")


def test_what_cannot_be_done_is_a_line():
    env = to_gymnasium(CORRIDOR)
    for call in (lambda: env.step(0), env.expert):
        with pytest.raises(ParameterError, match=r"no episode is under way; wanted reset\(\)"):
            call()
    with pytest.raises(ParameterError, match="the seed is 4294967296; wanted 0"):
        env.reset(seed=2**32)
    env.reset(seed=0)
    for wrong in (3, -1, 0.5, None, np.array([0.3], np.float32)):
        with pytest.raises(ActionError, match=r"wanted one of 0 \.\. 2"):
            env.step(wrong)
    over = False
    while not over:
        _, _, over, _, _ = env.step(env.expert())
    with pytest.raises(ParameterError, match="no episode is under way"):
        env.step(0)


def test_an_expert_that_is_asked_late_follows_from_then_on():
    followed = []

    class Follower(MiddleKeeper):
        def follow(self, observation):
            followed.append(observation.time_s)

    env = to_gymnasium(replace(CORRIDOR, expert=Follower))
    env.reset(seed=0)
    env.step(1)
    assert followed == []
    env.expert()
    env.step(1)
    env.reset(seed=0)
    assert followed == [1 / 50, 2 / 50, 0.0]


def test_gymnasium_makes_copies_of_it():
    env = to_gymnasium(CORRIDOR, "final", render_mode="rgb_array")
    assert env.spec is not None
    assert env.spec.id == "sheath/corridor-v0"
    again = env.spec.make()
    assert isinstance(again.unwrapped, TaskEnv)
    assert again.unwrapped.variant == "final"
    many = gymnasium.vector.SyncVectorEnv([lambda: to_gymnasium(CORRIDOR)] * 2)
    many.reset(seed=[1, 2])
    _, _, _, _, infos = many.step(np.array([0, 2]))
    assert list(infos["outcome"]) == ["time-limit"] * 2
