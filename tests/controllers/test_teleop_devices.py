"""What each device makes of what a page may send, which is anything."""

import sys
import time
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sheath_manip.cockpit import Cockpit, Gamepad, OperatorInput, Order, SixAxes
from sheath_manip.cockpit.spacemouse import SpaceMouse, six_axes
from sheath_manip.controllers.teleop.arm import ArmHands
from sheath_manip.controllers.teleop.buttons import ButtonHands
from sheath_manip.controllers.teleop.device import Device
from sheath_manip.controllers.teleop.gamepad import GamepadDevice
from sheath_manip.controllers.teleop.gizmo import Gizmo, pose_of, transform_of
from sheath_manip.controllers.teleop.keys import GUIDE, Keys
from sheath_manip.controllers.teleop.planar import PlanarHands
from sheath_manip.controllers.teleop.six_axes import SixAxesDevice
from sheath_manip.exceptions import SetupError
from sheath_manip.tasks.driving.entry import DRIVING
from sheath_manip.tasks.platformer.entry import PLATFORMER
from sheath_manip.tasks.robots.drive import TWIST_SCALE
from sheath_manip.types.operator_input import Binding
from tests.cases import cases
from tests.waiting import eventually

HERE = np.eye(4)
HERE[:3, 3] = 0.4, 0.0, 0.3
DEVICES: dict[str, Device] = {
    "keys": Keys(),
    "gamepad": GamepadDevice(),
    "gizmo": Gizmo(lambda: HERE, TWIST_SCALE),
    "six axes": SixAxesDevice(),
}
share = st.floats(-1, 1)
anything = st.builds(
    OperatorInput,
    st.frozensets(st.sampled_from([code for binding in GUIDE for code in binding.codes])),
    st.none() | st.builds(Gamepad, st.tuples(share, share, share, share), st.frozensets(
        st.integers(0, 31)
    )),
    st.none() | st.lists(st.floats(-10, 10), min_size=7, max_size=7).map(np.array),
    st.none() | st.builds(SixAxes, st.lists(share, min_size=6, max_size=6).map(np.array)),
)  # fmt: skip


@pytest.mark.parametrize("name", DEVICES)
@given(anything)
@cases(60)
def test_a_motion_is_finite_and_within_its_shares(name, given):
    motion = DEVICES[name].motion(given)
    assert motion.twist.shape == (6,)
    assert np.isfinite(motion.twist).all()
    assert np.abs(motion.twist).max() <= 1 + 1e-9
    assert motion.grip in (None, -1.0, 1.0)


@pytest.mark.parametrize("name", DEVICES)
def test_nothing_given_is_a_dead_man_let_go(name):
    assert not DEVICES[name].motion(OperatorInput()).dead_man


def arm() -> ArmHands:
    rest = np.array([0, 0, 0, 0, 0, 0, 0.3], np.float32)
    return ArmHands(lambda: HERE, rest.copy, TWIST_SCALE)


@given(anything)
@cases(60)
def test_an_arms_action_is_within_its_bounds(given):
    action = arm().action(given)
    assert action.dtype == np.float32
    assert np.isfinite(action).all()
    assert np.abs(action).max() <= 1


def test_devices_add_up_and_what_they_leave_open_stays():
    pad = Gamepad((0.0, 0.0, 0.0, -1.0), frozenset({4}))
    action = arm().action(OperatorInput(frozenset({"KeyI"}), pad))
    np.testing.assert_allclose(action, [0.6, 0, 1, 0, 0, 0, 0.3], atol=1e-6)
    np.testing.assert_allclose(arm().action(OperatorInput()), [0, 0, 0, 0, 0, 0, 0.3], atol=1e-6)


def planar() -> PlanarHands:
    return PlanarHands(lambda: HERE, lambda velocity: np.array(velocity, np.float32), 0.03)


@given(anything)
@cases(60)
def test_in_a_plane_nothing_is_faster_than_it_may_be(given):
    velocity = planar().action(given)
    assert np.isfinite(velocity).all()
    assert np.abs(velocity).max() <= np.float32(0.03)


def test_in_a_plane_devices_add_up_and_depth_and_turn_are_not_theirs():
    keys = OperatorInput(
        frozenset({"KeyI", "KeyU", "Digit5"}), Gamepad((-0.55, 0, 1, 1), frozenset({4}))
    )
    np.testing.assert_allclose(planar().action(keys), [0.018, 0.015], atol=1e-6)
    goal = pose_of(HERE)
    goal[:3] += 0.0015, 0.003, -0.2
    dragged = planar().action(OperatorInput(goal=goal))
    np.testing.assert_allclose(dragged, [0.006, 0.012], atol=1e-6)
    assert not planar().action(OperatorInput()).any()


def test_a_fine_key_slows_down_and_opposite_keys_cancel():
    keys = Keys()
    assert keys.motion(OperatorInput(frozenset({"KeyI", "KeyB"}))).twist[0] == pytest.approx(0.15)
    both = keys.motion(OperatorInput(frozenset({"KeyI", "KeyK", "KeyN"})))
    assert not both.twist.any()
    assert both.grip == 1.0
    assert both.dead_man
    assert not keys.motion(OperatorInput(frozenset({"KeyB"}))).dead_man


def test_sticks_want_the_shoulder_button_and_leave_their_dead_zone():
    pushed = (0.0, -1.0, 0.0, 0.09)
    assert not GamepadDevice().motion(OperatorInput(pad=Gamepad(pushed, frozenset({0})))).dead_man
    motion = GamepadDevice().motion(OperatorInput(pad=Gamepad(pushed, frozenset({4, 1}))))
    np.testing.assert_allclose(motion.twist, [1, 0, 0, 0, 0, 0])
    assert motion.grip == -1.0


def test_the_gizmo_leads_the_tool_in_a_straight_line():
    goal = pose_of(HERE)
    goal[:3] += 0.2, 0.4, 0.0
    twist = DEVICES["gizmo"].motion(OperatorInput(goal=goal)).twist
    np.testing.assert_allclose(twist, [0.5, 1, 0, 0, 0, 0], atol=1e-9)
    goal[:3] -= 0.1999, 0.3999, 0.0
    assert np.abs(DEVICES["gizmo"].motion(OperatorInput(goal=goal)).twist).max() < 0.01


def test_poses_there_and_back():
    pose = np.array([0.1, 0.2, 0.3, 0.5, 0.5, 0.5, 0.5])
    np.testing.assert_allclose(pose_of(transform_of(pose)), pose, atol=1e-12)


def test_a_car_and_a_player_by_keys_and_by_gamepad():
    assert DRIVING.teleop is not None
    assert PLATFORMER.teleop is not None
    wheel, player = DRIVING.teleop(None), PLATFORMER.teleop(None)
    assert isinstance(wheel, ButtonHands)
    left = wheel.action(OperatorInput(frozenset({"KeyJ"})))
    assert left[0] == np.float32(np.deg2rad(15.0))
    assert wheel.action(OperatorInput(pad=Gamepad((0.9, 0, 0, 0), frozenset())))[0] == -left[0]
    assert wheel.action(OperatorInput(frozenset({"KeyJ", "KeyL"})))[0] == 0
    run = player.action(
        OperatorInput(frozenset({"KeyL", "KeyI"}), Gamepad((0, 0, 0, 0), frozenset({2})))
    )
    assert run.tolist() == [0, 1, 1, 1]
    assert player.action(OperatorInput(frozenset({"KeyJ", "KeyL"}))).tolist() == [0, 0, 0, 0]


class Reading(SimpleNamespace):
    """As pyspacemouse has it: x right, y forward, z up."""


def reading(**axes: float) -> Reading:
    return Reading(**dict.fromkeys(("x", "y", "z", "roll", "pitch", "yaw"), 0.0) | axes)


def test_a_spacemouse_in_the_world_frame():
    state = reading(y=1.0, x=0.05, z=float("nan"))
    state.buttons = [0, 1]
    axes = six_axes(state)
    assert axes.twist.tolist() == [1, 0, 0, 0, 0, 0]
    assert axes.buttons == (False, True)
    state.buttons = []
    assert six_axes(state).buttons == (False, False)


def test_a_spacemouse_drives_for_who_has_taken_over_as_long_as_it_reports(monkeypatch):
    state = reading(z=-0.5)
    state.buttons, state.t = [1, 0], 0.0
    reports, closed = True, []

    def read():
        # As the package does: without a new report it returns the last one, and its time.
        if reports:
            state.t = time.monotonic() // 0.02
        return state

    device = SimpleNamespace(read=read, close=lambda: closed.append(True))
    module = ModuleType("pyspacemouse")
    module.open = lambda: device  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "pyspacemouse", module)
    cockpit = Cockpit((Binding(("KeyI",), "on"),))
    with SpaceMouse(cockpit):
        cockpit.order(Order.TAKE_OVER, "page")

        def driven() -> bool:
            cockpit.submit_input("page", OperatorInput())
            now = cockpit.now()
            return now.input is not None and now.input.held

        assert eventually(driven)
        action = arm().action(cockpit.input)
        np.testing.assert_allclose(action, [0, 0, -0.5, 0, 0, 0, 1], atol=1e-6)
        # Out of reach with its cap pressed: the arm holds.
        reports = False
        assert eventually(lambda: not driven())
        assert not any(driven() for _ in range(5))
    assert closed == [True]


def test_reports_of_a_spacemouse_that_have_queued_up_are_passed_over(monkeypatch):
    queue = [reading(z=each / 10) for each in range(1, 8)]
    for at, each in enumerate(queue):
        each.buttons, each.t = [0, 0], float(at)
    last = queue[-1]
    device = SimpleNamespace(read=lambda: queue.pop(0) if queue else last, close=lambda: None)
    module = ModuleType("pyspacemouse")
    module.open = lambda: device  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "pyspacemouse", module)
    heard: list[float] = []
    cockpit = Cockpit((Binding(("KeyI",), "on"),))
    monkeypatch.setattr(cockpit, "turn_axes", lambda axes: heard.append(axes.twist[2]))
    with SpaceMouse(cockpit):
        assert eventually(lambda: bool(heard))
    assert heard == [0.7]


@pytest.mark.parametrize("opened", [None, OSError("no hid device")])
def test_a_spacemouse_that_is_not_there_is_said_so(monkeypatch, opened):
    module = ModuleType("pyspacemouse")

    def open_device():
        if isinstance(opened, OSError):
            raise opened
        return opened

    module.open = open_device  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "pyspacemouse", module)
    with pytest.raises(SetupError, match="SpaceMouse"):
        SpaceMouse(Cockpit())
    monkeypatch.setitem(sys.modules, "pyspacemouse", None)
    with pytest.raises(SetupError, match=r"\[spacemouse\]"):
        SpaceMouse(Cockpit())
