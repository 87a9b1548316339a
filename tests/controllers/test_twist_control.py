"""The tool moves as commanded, within the joints' limits."""

import mink
import numpy as np
import pytest

from sheath_manip.exceptions import ParameterError
from sheath_manip.tasks.robots.kinematics import twist_control
from sheath_manip.tasks.robots.own_arm import ARM_WITH_JAW

TIMESTEP_S = 0.05
HOME = np.array(ARM_WITH_JAW.home_rad)


@pytest.fixture(scope="module")
def control():
    return twist_control(ARM_WITH_JAW, TIMESTEP_S)


def turned(before: np.ndarray, after: np.ndarray) -> np.ndarray:
    """(3,) rotation vector in the world frame, for small turns."""
    r = after[:3, :3] @ before[:3, :3].T
    return 0.5 * np.array([r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]])


@pytest.mark.parametrize("axis", range(6))
def test_a_twist_moves_the_tool_along_the_axes_of_the_world(control, axis):
    twist = np.zeros(6)
    twist[axis] = 0.1 if axis < 3 else 0.4
    before = control.transform_tool_to_world(HOME)
    after = control.transform_tool_to_world(control.joint_targets(HOME, twist))
    moved = np.concatenate([after[:3, 3] - before[:3, 3], turned(before, after)])
    np.testing.assert_allclose(moved, twist * TIMESTEP_S, atol=3e-4)


def test_joints_keep_their_ranges_and_speeds(control):
    rng = np.random.default_rng(0)
    lower, upper = control.model.jnt_range.T
    top = np.array(list(ARM_WITH_JAW.joint_speeds_rad_s.values()))
    targets = HOME
    for _ in range(300):
        twist = rng.uniform(-1, 1, 6) * [2, 2, 2, 8, 8, 8]
        moved = control.joint_targets(targets, twist)
        assert (moved >= lower - 1e-6).all()
        assert (moved <= upper + 1e-6).all()
        assert (np.abs(moved - targets) <= top * TIMESTEP_S + 1e-6).all()
        targets = moved


def test_it_is_what_mink_makes_of_the_same_objectives_and_limits(control):
    configuration = mink.Configuration(control.model)
    tool = mink.FrameTask(ARM_WITH_JAW.tool_site, "site", 1.0, orientation_cost=0.3)
    posture = mink.PostureTask(control.model, cost=1e-3)
    posture.set_target(HOME)
    speeds = ARM_WITH_JAW.joint_speeds_rad_s
    limits = [mink.ConfigurationLimit(control.model), mink.VelocityLimit(control.model, speeds)]
    rng = np.random.default_rng(1)
    lower, upper = control.model.jnt_range.T
    for spread in (0.1, 0.5, 3.0) * 40:
        start = np.clip(HOME + rng.normal(size=6) * spread, lower, upper)
        twist = rng.uniform(-1, 1, 6) * spread
        configuration.update(start)
        pose = configuration.get_transform_frame_to_world(ARM_WITH_JAW.tool_site, "site")
        turned = mink.SO3.exp(twist[3:] * TIMESTEP_S) @ pose.rotation()
        moved = pose.translation() + twist[:3] * TIMESTEP_S
        tool.set_target(mink.SE3.from_rotation_and_translation(turned, moved))
        rates = mink.solve_ik(
            configuration, [tool, posture], TIMESTEP_S, "daqp", damping=1e-6, limits=limits
        )
        wanted = configuration.integrate(rates, TIMESTEP_S)
        np.testing.assert_allclose(control.joint_targets(start, twist), wanted, atol=1e-9)


def test_without_a_twist_it_stays(control):
    targets = HOME
    for _ in range(100):
        targets = control.joint_targets(targets, np.zeros(6))
    np.testing.assert_allclose(targets, HOME, atol=1e-4)


def test_takes_single_precision_and_refuses_what_is_no_twist(control):
    control.joint_targets(HOME.astype(np.float32), np.full(6, 0.1, np.float32))
    with pytest.raises(ParameterError, match="6 finite"):
        control.joint_targets(HOME, np.full(6, np.nan))
    with pytest.raises(ParameterError, match="6 finite"):
        control.joint_targets(HOME, np.zeros(7))
