"""What a person's hands on every task must do, whatever its devices say."""

import random
from collections.abc import Iterator

import numpy as np
import pytest

from sheath_manip.cockpit import Gamepad, OperatorInput, SixAxes
from sheath_manip.dashboard.operator_socket import HOTKEYS
from sheath_manip.protocols import Environment, Teleop
from sheath_manip.tasks.table import TASKS

SEED = 77
OF_THE_CAMERA = {f"Key{letter}" for letter in "WASDQE"} | {
    f"Arrow{way}" for way in ("Up", "Down", "Left", "Right")
}
"""by which viser flies it"""


@pytest.fixture(params=[name for name in sorted(TASKS) if TASKS[name].teleop], scope="module")
def name(request) -> str:
    return request.param


@pytest.fixture(scope="module")
def environment(name) -> Iterator[Environment]:
    environment = TASKS[name].make()
    environment.reset(SEED)
    yield environment
    environment.close()


@pytest.fixture(scope="module")
def hands(name, environment) -> Teleop:
    make = TASKS[name].teleop
    assert make is not None
    return make(environment)


def anything(rng: random.Random, codes: list[str]) -> OperatorInput:
    """What devices may say at once."""
    pad = Gamepad(
        (rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)),
        frozenset(rng.sample(range(17), rng.randrange(5))),
    )
    goal = np.array([rng.uniform(-3, 3) for _ in range(7)])
    axes = SixAxes(np.array([rng.uniform(-1, 1) for _ in range(6)]), (rng.random() < 0.5, False))
    return OperatorInput(
        frozenset(rng.sample(codes, rng.randrange(len(codes)))),
        rng.choice([None, pad]),
        rng.choice([None, goal]),
        rng.choice([None, axes]),
    )


def test_any_input_is_a_valid_action(hands, environment):
    spec = environment.spec.action
    codes = [code for binding in hands.guide for code in binding.codes]
    rng = random.Random(0)
    for _ in range(100):
        action = spec.validated(hands.action(anything(rng, codes)))
        if spec.choices is not None:
            assert (np.abs(spec.choices - action).max(axis=1) < 1e-6).any()


def test_looking_changes_nothing(hands, environment):
    before = environment.state()
    hands.action(OperatorInput())
    hands.tool_pose()
    np.testing.assert_array_equal(environment.state(), before)


def test_its_keys_have_one_purpose_and_fly_no_camera(hands):
    codes = [code for binding in hands.guide for code in binding.codes]
    assert len(set(codes)) == len(codes) > 0
    assert not set(codes) & (OF_THE_CAMERA | HOTKEYS.keys())
    assert not HOTKEYS.keys() & OF_THE_CAMERA
    assert all(binding.says for binding in hands.guide)


def test_a_tool_that_can_be_dragged_has_a_pose(hands):
    pose = hands.tool_pose()
    if pose is not None:
        assert pose.shape == (7,)
        assert np.linalg.norm(pose[3:]) == pytest.approx(1.0)
