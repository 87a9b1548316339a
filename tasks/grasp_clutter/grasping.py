"""The expert's law: where to move from any state. It knows no phases and remembers nothing.

What to do is a field over the states: up where the jaw is low and beside the target, across where
it is high, down where it is above the target, closing where the pads are around it, lifting where
they press. All of it goes over into one another without a jump, so that labels of neighbouring
states agree; what does not matter, such as a few degrees of yaw, is left as it is.

Lengths without a name are how much of an error is left alone, and over how much more it comes to
count in full.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sheath_manip.controllers.closing_control import ClosingControl
from sheath_manip.tasks.grasp_clutter.grasp_state import GraspCommand, GraspState, Intent
from sheath_manip.tasks.grasp_clutter.room import JawRoom

TRANSIT_HEIGHT_M = 0.30
"""of the pinch: the finger tips pass 2.5 cm over the tallest clutter"""
LIFT_HEIGHT_M = 0.15
_LEAST_ROOM_M = 0.003
"""with less than this around the jaw, however it is turned, there is no safe way in"""
_DEEP_M = 0.045
"""of an object between the fingers: with less the gripper has to be placed more exactly"""
_UPRIGHT_RAD = 0.02
"""up to which an object only rocks on its foot"""
_GAIN_HZ = 4.0
_TRANSIT_M_S, _CLIMB_M_S, _DESCENT_M_S, _FINE_M_S, _LIFT_M_S = 0.25, 0.2, 0.12, 0.08, 0.15
_FREEING_M_S = 0.1
_TURN_RAD_S = 1.2


@dataclass(frozen=True, eq=False)
class _Fit:
    """How the target lies in the jaw."""

    error_m: NDArray[np.float64]
    """(3,) from the pinch to where it grasps"""
    along_m: float
    """how much of that lies along the way of the fingers"""
    across_m: float
    spare_m: float
    """how much more the jaw is open than the target is wide; negative where it is less"""
    entered: float
    """0..1, how far the finger tips are below the target's top, one on each side"""
    around: float
    """0..1, how far the target is between the pads"""


@dataclass(frozen=True)
class GraspLaw:
    """The field for one gripper."""

    room: JawRoom
    closing: ClosingControl
    tip_m: float
    """from the pinch to the finger tips"""
    depth_m: float
    """how much of the target has room above the pinch"""

    @property
    def shallow(self) -> float:
        """Up to 1, by which lengths along the approach count less in a gripper of short fingers."""
        return min(1.0, (self.tip_m + self.depth_m) / _DEEP_M)

    def command(self, state: GraspState) -> GraspCommand:
        """Return what to do in `state`."""
        fit = self._fit(state)
        yaw_error, best_room = self.room.least_turn(state, state.tool_position_m + fit.error_m)
        tilt_turn = _turn_down(state.tool_rotation[:, 0])
        blocked = best_room < _LEAST_ROOM_M and fit.around < 0.5
        down = self._down(state, fit, abs(yaw_error), float(np.linalg.norm(tilt_turn)))
        if blocked:
            down = -1.0

        twist = np.zeros(6)
        twist[:3] = _velocity(state, fit, down, blocked)
        twist[3:] = _GAIN_HZ * tilt_turn
        twist[5] += _GAIN_HZ * yaw_error
        twist[3:] = _capped(twist[3:], _TURN_RAD_S)

        arrived = min(
            _ramp(0.010 - fit.along_m, 0.004),
            _ramp(0.014 - fit.across_m, 0.004),
            _ramp(0.020 * self.shallow - abs(fit.error_m[2]), 0.008 * self.shallow),
        )
        close = max(arrived, fit.around * _ramp(0.02 - fit.spare_m, 0.01))
        grip = 2 * close - 1
        if close == 0.0 and not self._may_open(state, fit):
            grip = self.closing.holding_grip(state.closed_m)
        # What leans was pushed. Any way aside may push on, and turning does; straight up does not.
        low = 1 - _ramp(state.tool_position_m[2] - (TRANSIT_HEIGHT_M - 0.05), 0.03)
        freeing = low * _ramp(state.leaning_rad - _UPRIGHT_RAD, 0.03)
        twist *= 1 - freeing
        twist[2] += freeing * _FREEING_M_S
        pressing = _ramp(state.pressed_m - 0.008, 0.008)
        held = fit.around * pressing * _ramp(0.01 - fit.spare_m, 0.004)
        lift = _clipped(_GAIN_HZ * (LIFT_HEIGHT_M - state.target_base_m[2]), -0.1, _LIFT_M_S)
        twist *= 1 - held
        twist[2] += held * lift
        # Something else is between the pads: it is set down before it is let go.
        wrong = pressing * (1 - fit.around) * float(state.closed_m < self.closing.opening_m - 0.01)
        if wrong > 0:
            lowered = -_clipped(_GAIN_HZ * state.raised_m, 0.0, 0.1)
            twist *= 1 - wrong
            twist[2] += wrong * lowered * float(state.raised_m > 0.004)
            grip = 1.0 if state.raised_m > 0.012 else -1.0
        intent = _intent(held, wrong, close, down, blocked, state.tool_position_m[2])
        return GraspCommand(twist, float(grip), intent, fit.around, arrived)

    def _fit(self, state: GraspState) -> _Fit:
        grasp_m = max(0.045, state.target_height_m - self.depth_m)
        goal = state.target_base_m + grasp_m * state.target_axis
        error = goal - state.tool_position_m
        way = state.tool_rotation[:2, 1]
        way = way / max(float(np.linalg.norm(way)), 1e-6)
        along = abs(float(way @ error[:2]))
        across = abs(float(way[0] * error[1] - way[1] * error[0]))
        depth = self.tip_m + state.target_height_m - grasp_m + error[2]
        room = self.closing.opening_m / 2 - state.target_radius_m
        in_depth = _ramp(depth - 0.01 * self.shallow, 0.02 * self.shallow)
        entered = in_depth * _ramp(room + 0.004 - along, 0.006)
        return _Fit(
            error_m=error,
            along_m=along,
            across_m=across,
            spare_m=self.closing.opening_m - state.closed_m - 2 * state.target_radius_m,
            entered=entered,
            around=min(entered, _ramp(0.020 - across, 0.008)),
        )

    def _down(self, state: GraspState, fit: _Fit, yaw_error: float, tilt: float) -> float:
        """1: down to the grasp; 0: stay at this height; -1: up to where nothing stands."""
        room = self.closing.opening_m / 2 - state.target_radius_m
        return min(
            _both(room - 0.002 - fit.along_m, 0.006),
            # With a finger on each side the target is best reached across, not from above.
            max(
                _both(0.016 - fit.across_m, 0.008),
                fit.entered * _ramp(0.05 - fit.across_m, 0.01) - 1,
            ),
            max(_both(fit.spare_m - 0.002, 0.008), 2 * fit.around - 1),
            # These two can be mended at any height.
            _ramp(0.35 - yaw_error, 0.15),
            _ramp(0.25 - tilt, 0.1),
        )

    def _may_open(self, state: GraspState, fit: _Fit) -> bool:
        """Whether opening where the jaw is pushes nothing."""
        position, base = state.tool_position_m, state.target_base_m
        over = position[2] - self.tip_m > base[2] + state.target_height_m
        beside = float(np.linalg.norm(base[:2] - position[:2])) > 0.11
        inside = fit.along_m < (self.closing.opening_m - state.closed_m) / 2
        return (over or beside or inside) and self.room.here(state) > 0.002


def _velocity(state: GraspState, fit: _Fit, down: float, blocked: bool) -> NDArray[np.float64]:
    """(3,) of the tool while it holds nothing, m/s."""
    height = state.tool_position_m[2]
    high = _ramp(height - (TRANSIT_HEIGHT_M - 0.05), 0.03)
    sideways = high if blocked else max(high, min(1.0, down + 1.0))
    top = _FINE_M_S + (_TRANSIT_M_S - _FINE_M_S) * high
    velocity = np.zeros(3)
    velocity[:2] = sideways * _capped(_GAIN_HZ * fit.error_m[:2], top)
    if down >= 0:
        velocity[2] = down * _clipped(_GAIN_HZ * fit.error_m[2], -_DESCENT_M_S, 0.1)
    else:
        climb = _GAIN_HZ * (TRANSIT_HEIGHT_M - height)
        velocity[2] = -down * _clipped(climb, -_CLIMB_M_S, _CLIMB_M_S)
    return velocity


def _turn_down(approach: NDArray) -> NDArray[np.float64]:
    """(3,) rotation vector that points (3,) `approach` straight down."""
    # Its cross product with straight down.
    axis = np.array([-approach[1], approach[0], 0.0])
    sine = float(np.linalg.norm(axis))
    if sine < 1e-9:
        # Down already, or up, where any way will do.
        return np.array([0.0, np.pi if approach[2] > 0 else 0.0, 0.0])
    return axis / sine * np.arctan2(sine, -approach[2])


def _ramp(value: float, width: float) -> float:
    """0 below 0, 1 beyond `width`."""
    return _clipped(value / width, 0.0, 1.0)


def _both(value: float, width: float) -> float:
    """-1 below -width, 1 beyond `width`."""
    return _clipped(value / width, -1.0, 1.0)


def _clipped(value: float, least: float, most: float) -> float:
    # numpy takes ten times as long over a single number, and here are some twenty a step.
    return float(min(max(value, least), most))


def _capped(vector: NDArray, most: float) -> NDArray[np.float64]:
    length = float(np.linalg.norm(vector))
    return vector * min(1.0, most / length) if length > 0 else vector


def _intent(
    held: float, wrong: float, close: float, down: float, blocked: bool, height: float
) -> Intent:
    if held > 0.5:
        return Intent.LIFT
    if wrong > 0.5:
        return Intent.RELEASE
    if close > 0.5:
        return Intent.CLOSE
    if blocked:
        return Intent.BACK_OUT
    if down > 0:
        return Intent.APPROACH
    return Intent.TRANSIT if height > TRANSIT_HEIGHT_M - 0.05 else Intent.RETREAT
