"""The command filter holds every limit, whatever it is told."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from sheath_manip.controllers.command_filter import (
    ACCELERATION,
    MALFORMED,
    RANGE,
    SPEED,
    CommandFilter,
)
from sheath_manip.controllers.joint_limits import JointLimits
from sheath_manip.exceptions import ParameterError
from sheath_manip.tasks.robots.filtering import command_filter
from sheath_manip.tasks.robots.own_arm import ARM_WITH_JAW
from tests.cases import cases
from tests.controllers.watched_filter import HOME, TIMESTEP_S, Watched, arm, careful_arm, names

__all__ = ["arm", "careful_arm"]

targets = arrays(np.float64, 6, elements=st.floats(-4, 4))
steps = arrays(np.float64, 6, elements=st.floats(-0.3, 0.3))
malformed = st.one_of(
    st.none(),
    st.just("left"),
    st.just([0.0, 1.0]),
    st.just(np.zeros((2, 6))),
    arrays(np.float64, 6, elements=st.sampled_from([np.nan, np.inf, -np.inf, 1e308, -1e308])),
)
command = st.one_of(
    st.tuples(st.just("to"), targets),
    st.tuples(st.just("by"), steps),
    st.tuples(st.just("raw"), malformed),
)
stretch = st.tuples(command, st.integers(1, 12))


@cases(40)
@given(st.lists(stretch, min_size=1, max_size=6))
def test_any_commands_are_held_within_all_limits(arm, stretches):
    watched = Watched(arm, HOME)
    for (kind, value), count in stretches:
        for _ in range(count):
            watched.step(watched.targets + value if kind == "by" else value)


def adversary(guard: CommandFilter, watched: Watched, rng: np.random.Generator, number: int):
    """What most likely breaks a limit, changing its mind every few steps."""
    joints = guard.joints
    kind = number // 7 % 8
    along = np.sign(watched.velocities) + (watched.velocities == 0)
    corner = np.where(rng.random(6) < 0.5, joints.lower_rad, joints.upper_rad)
    if kind == 0:
        return watched.targets + rng.normal(size=6) * 0.2
    if kind == 1:
        return watched.targets + along
    if kind == 2:
        return watched.targets + (1 if number % 2 else -1) * joints.speeds_rad_s * TIMESTEP_S
    if kind == 3:
        return rng.choice([np.nan, np.inf, 1e308, 0.0], 6)
    if kind == 4:
        # Folded over its own foot, or under the table.
        return np.array([rng.uniform(-2, 2), rng.choice([-2.2, 1.2]), 2.7, 2.4, 0.0, 0.0])
    if kind == 5:
        return HOME + rng.uniform(-3, 3, 6) * (rng.random(6) < 0.3)
    return corner if kind == 6 else watched.targets + (corner - watched.targets) * 0.02


@pytest.mark.parametrize(
    ("kind", "count"),
    [
        ("arm", 1000),
        ("careful_arm", 500),
        pytest.param("arm", 20_000, marks=pytest.mark.soak),
        pytest.param("careful_arm", 10_000, marks=pytest.mark.soak),
    ],
)
def test_an_adversary_breaks_no_limit(kind, count, request):
    guard = request.getfixturevalue(kind)
    rng = np.random.default_rng(5)
    watched = Watched(guard, HOME)
    acted: set[str] = set()
    for number in range(count):
        # A stretch keeps its draws, so that it gets somewhere.
        draws = np.random.default_rng([5, number // 7])
        acted |= {
            each.limit for each in watched.step(adversary(guard, watched, draws, number)).limited
        }
        if number % 500 == 499:
            watched = Watched(guard, HOME + rng.uniform(-0.05, 0.05, 6))
    assert guard.speed_cap is not None
    wanted = {MALFORMED, SPEED, ACCELERATION, RANGE, "workspace", "collision", guard.speed_cap.name}
    assert acted == wanted


def test_a_command_within_the_limits_passes_unchanged(arm):
    watched = Watched(arm, HOME)
    for number in range(60):
        wished = watched.targets + 0.01 * np.sin(number / 10) * np.array([1, -1, 1, 0.5, 1, 1])
        admitted = watched.step(wished)
        np.testing.assert_allclose(admitted.targets_rad, wished, atol=1e-12)
        assert admitted.limited == ()


@pytest.mark.parametrize("bad", [None, "left", [np.nan] * 6, [0.0] * 5, [1e308] * 6, [[0], [1, 2]]])
def test_a_malformed_command_brings_the_arm_to_rest_and_says_so(arm, bad):
    watched = Watched(arm, HOME)
    for _ in range(5):
        watched.step(watched.targets + 0.05)
    assert np.abs(watched.velocities).max() > 0.5
    for _ in range(arm.stopping.steps):
        admitted = watched.step(bad)
        assert MALFORMED in names(admitted)
    np.testing.assert_array_equal(watched.velocities, 0)


@pytest.mark.parametrize(("joint", "end"), [(0, "upper"), (2, "upper"), (5, "lower")])
def test_a_joint_gets_to_its_end_and_stays_there(joint, end):
    free = CommandFilter(joints_of_the_arm(), TIMESTEP_S)
    watched = Watched(free, HOME)
    goal = HOME.copy()
    limit = free.joints.upper_rad if end == "upper" else free.joints.lower_rad
    goal[joint] = limit[joint] + (1 if end == "upper" else -1)
    acted = set[str]()
    for _ in range(80):
        acted |= names(watched.step(goal))
    assert abs(watched.targets[joint] - limit[joint]) < 2e-3
    assert RANGE in acted


def joints_of_the_arm() -> JointLimits:
    return command_filter(ARM_WITH_JAW, TIMESTEP_S).joints


def test_it_goes_on_from_its_memory_to_the_bit(arm):
    rng = np.random.default_rng(3)
    wishes = HOME + rng.normal(size=(40, 6))
    first = Watched(arm, HOME)
    for wish in wishes[:20]:
        first.step(wish)
    memory = arm.memory()
    ends = [arm.step(wish).targets_rad for wish in wishes[20:]]
    arm.reset(HOME)
    arm.step(wishes[0])
    arm.recall(memory)
    np.testing.assert_array_equal(arm.memory(), memory)
    for wish, end in zip(wishes[20:], ends, strict=True):
        np.testing.assert_array_equal(arm.step(wish).targets_rad, end)


def test_it_starts_only_where_it_may_be(arm):
    with pytest.raises(ParameterError, match="range"):
        arm.reset(HOME + 10)
    with pytest.raises(ParameterError, match="range"):
        arm.reset(np.full(6, np.nan))
    low = HOME.copy()
    low[1] = 1.0
    with pytest.raises(ParameterError, match="within the limits"):
        arm.reset(low)
