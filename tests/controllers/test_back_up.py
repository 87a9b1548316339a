"""Who stands in where there is no expert: still, or back by the way that was come."""

from itertools import pairwise

import mujoco
import numpy as np
import pytest

from sheath_manip.controllers.back_up import BackUp
from sheath_manip.controllers.hold import Hold
from sheath_manip.controllers.trail import Trail
from sheath_manip.exceptions import ParameterError
from sheath_manip.types import Action, Observation

SCALE = np.array([0.25, 0.25, 0.25, 1.5, 1.5, 1.5])
TIMESTEP_S = 0.05
SEEN = Observation({}, np.zeros(0, np.float32), 0.0)


def moved(pose: np.ndarray, twist: np.ndarray) -> np.ndarray:
    quaternion, turn = np.zeros(4), np.zeros(9)
    angle = np.linalg.norm(twist[3:]) * TIMESTEP_S
    mujoco.mju_axisAngle2Quat(quaternion, twist[3:] / max(angle / TIMESTEP_S, 1e-12), angle)
    mujoco.mju_quat2Mat(turn, quaternion)
    after = pose.copy()
    after[:3, :3] = turn.reshape(3, 3) @ pose[:3, :3]
    after[:3, 3] += twist[:3] * TIMESTEP_S
    return after


class Tool:
    """Does exactly as it is told."""

    def __init__(self) -> None:
        self.pose = np.eye(4)

    def now(self) -> np.ndarray:
        return self.pose.copy()

    def rest(self) -> Action:
        return np.array([0, 0, 0, 0, 0, 0, 0.3], np.float32)

    def move(self, action: np.ndarray) -> None:
        self.pose = moved(self.pose, action[:6] * SCALE)


def walk(tool: Tool, back_up: BackUp, steps: int, rng: np.random.Generator) -> list[np.ndarray]:
    """Somewhere, around corners."""
    places, action = [], np.zeros(7)
    for number in range(steps):
        if number % 12 == 0:
            action = np.append(rng.uniform(-1, 1, 6), 0.0)
        back_up.follow(SEEN)
        places.append(tool.now())
        tool.move(action)
    return places


def backing(tool: Tool) -> BackUp:
    back_up = BackUp(tool.now, tool.rest, SCALE, TIMESTEP_S)
    back_up.reset()
    return back_up


def retreat(tool: Tool, back_up: BackUp, steps: int) -> list[Action]:
    actions = []
    for _ in range(steps):
        back_up.follow(SEEN)
        actions.append(back_up.act(SEEN))
        tool.move(actions[-1])
    return actions


def test_backs_up_along_its_path_to_where_it_began():
    tool = Tool()
    back_up = backing(tool)
    places = walk(tool, back_up, 60, np.random.default_rng(1))
    length = sum(np.linalg.norm(a[:3, 3] - b[:3, 3]) for a, b in pairwise(places))
    for action in retreat(tool, back_up, 200):
        assert np.abs(action[:6]).max() <= 0.6 + 1e-6
        assert action.dtype == np.float32
        assert action[6] == np.float32(0.3)
        nearest = min(np.linalg.norm(tool.pose[:3, 3] - place[:3, 3]) for place in places)
        assert nearest < 0.012
    assert length > 0.3
    np.testing.assert_allclose(tool.pose, np.eye(4), atol=1e-3)
    # There it stays.
    np.testing.assert_allclose(back_up.act(SEEN)[:6], 0, atol=1e-3)


def test_a_second_retreat_does_not_go_forward_again():
    tool = Tool()
    back_up = backing(tool)
    forward = np.array([1, 0, 0, 0, 0, 0, 0.0])
    for _ in range(40):
        back_up.follow(SEEN)
        tool.move(forward)
    retreat(tool, back_up, 20)
    half_way = tool.pose[0, 3]
    assert 0.2 < half_way < 0.45
    # The policy acts for a moment, another way.
    for _ in range(5):
        back_up.follow(SEEN)
        tool.move(np.array([0, 1, 0, 0, 0, 0, 0.0]))
    for action in retreat(tool, back_up, 100):
        assert action[0] < 0.05
    assert np.linalg.norm(tool.pose[:3, 3]) < 2e-3


def test_without_a_way_back_it_rests():
    tool = Tool()
    back_up = backing(tool)
    np.testing.assert_array_equal(back_up.act(SEEN), tool.rest())
    back_up.follow(SEEN)
    np.testing.assert_array_equal(back_up.act(SEEN), tool.rest())


def test_an_episode_does_not_retreat_into_the_one_before():
    tool = Tool()
    back_up = backing(tool)
    walk(tool, back_up, 30, np.random.default_rng(2))
    back_up.reset()
    back_up.follow(SEEN)
    np.testing.assert_array_equal(back_up.act(SEEN), tool.rest())


def test_a_trail_forgets_its_oldest_waypoints():
    trail = Trail(longest=5)
    for number in range(50):
        pose = np.eye(4)
        pose[0, 3] = 0.011 * number
        trail.pass_through(pose)
    assert len(trail) == 5


def test_hold_asks_for_rest():
    tool = Tool()
    expert = Hold(tool.rest)
    expert.reset()
    np.testing.assert_array_equal(expert.act(SEEN), tool.rest())


def test_odd_parameters_are_refused():
    tool = Tool()
    with pytest.raises(ParameterError, match="speed share"):
        BackUp(tool.now, tool.rest, SCALE, TIMESTEP_S, speed_share=0.0)
    with pytest.raises(ParameterError, match="waypoints"):
        Trail(spacing_m=0.0)
