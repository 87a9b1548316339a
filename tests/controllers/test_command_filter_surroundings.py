"""The command filter among a wall, a table and clutter: it slides along, stops and slows down."""

import mujoco
import numpy as np

from sheath_manip.controllers.command_filter import CommandFilter
from sheath_manip.controllers.joint_limits import JointLimits
from sheath_manip.controllers.workspace import Workspace
from tests.controllers.watched_filter import HOME, TIMESTEP_S, Watched, arm, careful_arm, names

__all__ = ["arm", "careful_arm"]


def twist(guard: CommandFilter, velocity_m_s: np.ndarray) -> np.ndarray:
    """Joint targets that move the tool so, by finite differences."""
    workspace, now = guard.workspace, guard.targets_rad
    assert workspace is not None
    here = workspace.tool_position_m(now)
    jacobian = np.stack(
        [(workspace.tool_position_m(now + 1e-5 * row) - here) / 1e-5 for row in np.eye(6)], axis=1
    )
    return now + np.linalg.pinv(jacobian) @ velocity_m_s * TIMESTEP_S


def test_pushed_into_a_wall_it_slides_along(arm):
    watched = Watched(arm, HOME)
    for _ in range(120):
        watched.step(twist(arm, np.array([0.2, 0.0, 0.0])))
    wall_m = arm.workspace.upper_m[0]
    reached = arm.workspace.tool_position_m(watched.targets)
    assert wall_m - reached[0] < 2e-3
    for _ in range(30):
        admitted = watched.step(twist(arm, np.array([0.2, 0.1, 0.0])))
        assert "workspace" in names(admitted)
    slid = arm.workspace.tool_position_m(watched.targets) - reached
    assert slid[1] > 0.1
    assert abs(slid[0]) < 5e-3


def test_pressed_down_it_stops_over_the_table(arm):
    watched = Watched(arm, HOME)
    acted = set[str]()
    for _ in range(150):
        acted = names(watched.step(twist(arm, np.array([0.0, 0.0, -0.25]))))
    assert acted & {"workspace", "collision"}
    assert arm.workspace.distance_m(watched.targets) < 0.012
    low_m = arm.workspace.tool_position_m(watched.targets)[2]
    for _ in range(20):
        watched.step(twist(arm, np.array([0.0, 0.0, 0.25])))
    assert arm.workspace.tool_position_m(watched.targets)[2] > low_m + 0.15


def test_it_slows_down_near_clutter_that_the_task_tells_of(careful_arm):
    watched = Watched(careful_arm, HOME)
    speeds = []
    for _ in range(30):
        before = careful_arm.workspace.tool_position_m(watched.targets)
        admitted = watched.step(twist(careful_arm, np.array([0.1, 0.0, -0.25])))
        after = careful_arm.workspace.tool_position_m(watched.targets)
        speeds.append((np.linalg.norm(after - before) / TIMESTEP_S, names(admitted)))
    assert max(speed for speed, _ in speeds) > 0.2
    assert any(speed < 0.15 and "speed near clutter" in acted for speed, acted in speeds)


SLIDER = """
<mujoco><compiler angle="radian" autolimits="true"/><worldbody>
  <geom name="wall" type="box" size=".05 1 1" pos="1 0 0"/>
  <body name="cart"><joint name="along" type="slide" axis="1 0 0" range="-2 2"/>
    <geom name="cart" size=".1"/>
    <body name="arm" pos="0 0 .3"><joint name="turn" axis="0 0 1"/>
      <geom name="arm" type="capsule" size=".05" fromto="0 0 0 .3 0 0"/>
      <site name="tip" pos=".3 0 0"/>
    </body></body>
</worldbody></mujoco>
"""


def test_any_arm_will_do():
    model = mujoco.MjModel.from_xml_string(SLIDER)
    home = np.zeros(2)
    box = np.array([-5.0, -5.0, -5.0]), np.array([5.0, 5.0, 5.0])
    guard = CommandFilter(
        JointLimits.of(model, (1.0, 4.0)), TIMESTEP_S, Workspace(model, "tip", home, *box)
    )
    assert guard.workspace is not None
    assert sorted(guard.workspace.compared) == [("wall", "arm"), ("wall", "cart")]
    watched = Watched(guard, home)
    for number in range(150):
        watched.step(np.array([1.5, 3.0 * np.sin(number / 9)]))
    # The wall begins at .95, and the cart is .1 round.
    assert 0.8 < watched.targets[0] < 0.85
