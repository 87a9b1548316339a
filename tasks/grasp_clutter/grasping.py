"""The expert's law: where to move from any state. It knows no phases and remembers nothing.

What to do is a field over the states: up where the jaw is low and beside the target, across where
it is high, down where it is above the target, closing where the pads are around it, lifting where
they press. All of it goes over into one another without a jump, so that labels of neighbouring
states agree; what does not matter, such as a few degrees of yaw, is left as it is.
"""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from controllers.closing_control import ClosingControl
from controllers.footprint import clearances
from tasks.robots.robot import Footprint

TRANSIT_HEIGHT_M = 0.30
"""of the pinch: the finger tips pass a hand's breadth of 2.5 cm over the tallest clutter"""
LIFT_HEIGHT_M = 0.15
_TIP_M = 0.035
"""from the pinch to the finger tips"""
_ROOM_M = 0.014
"""wanted around the jaw: what the collision limit keeps, and a little"""
_LEAST_ROOM_M = 0.003
"""with less than this around the jaw, however it is turned, there is no safe way in"""
_YAWS_RAD = np.linspace(0, np.pi, 60, endpoint=False)
_GAIN_HZ = 4.0
_TRANSIT_M_S, _CLIMB_M_S, _DESCENT_M_S, _FINE_M_S, _LIFT_M_S = 0.25, 0.2, 0.12, 0.08, 0.15
_TURN_RAD_S = 1.2


class Intent(StrEnum):
    """What the expert is about, for people; it follows from the state like the action."""

    TRANSIT = "transit"
    APPROACH = "approach"
    CLOSE = "close"
    LIFT = "lift"
    RETREAT = "retreat"
    RELEASE = "release"
    BACK_OUT = "back out: no safe way in"


@dataclass(frozen=True, eq=False)
class GraspState:
    """What the law looks at. All in the world frame."""

    tool_position_m: NDArray[np.float64]
    """(3,) of the pinch"""
    tool_rotation: NDArray[np.float64]
    """(3, 3) its columns are the approach, the way of the fingers, their product"""
    turn_range_rad: tuple[float, float]
    """how far the tool can turn about the vertical, by its last joint"""
    closed_m: float
    """how far the gripper is closed"""
    pressed_m: float
    """how far its servo's target is beyond that"""
    target_base_m: NDArray[np.float64]
    """(3,) the centre of the target's foot"""
    target_axis: NDArray[np.float64]
    """(3,) the way that it stands"""
    target_radius_m: float
    target_height_m: float
    outlines_m: NDArray[np.float64]
    """(p, 2) points on the outlines of the clutter"""
    outline_heights_m: NDArray[np.float64]
    """(p,) up to which they reach"""
    raised_m: float
    """how high the highest foot of the clutter is"""


@dataclass(frozen=True, eq=False)
class GraspCommand:
    """What the expert wants before anything is in its way."""

    twist: NDArray[np.float64]
    """(6,) m/s and rad/s"""
    grip: float
    """-1 open .. 1 closed"""
    intent: Intent
    around: float
    """0..1, how far the target is between the pads"""
    arrived: float
    """0..1, how far the jaw is where it is to close"""


@dataclass(frozen=True)
class GraspLaw:
    """The field for one gripper."""

    footprints: tuple[Footprint, ...]
    closing: ClosingControl

    def command(self, state: GraspState) -> GraspCommand:
        """What to do in `state`."""
        opening = self.closing.opening_m - state.closed_m
        width = 2 * state.target_radius_m
        grasp_m = max(0.045, state.target_height_m - 0.05)
        goal = state.target_base_m + grasp_m * state.target_axis
        error = goal - state.tool_position_m
        along, across = self._in_jaw(state, error)
        height = state.tool_position_m[2]

        # How far the target is between the pads, however they stand otherwise.
        room = (self.closing.opening_m - width) / 2
        depth = _TIP_M + state.target_height_m - grasp_m + error[2]
        beside = _ramp(room + 0.004 - along, 0.006)
        deep = _ramp(depth - 0.01, 0.02)
        around = min(beside, deep, _ramp(0.020 - across, 0.008))

        yaw_error, best_room = self._yaw_error(state, goal)
        tilt_turn = np.cross(state.tool_rotation[:, 0], [0.0, 0.0, -1.0])
        tilt = float(np.linalg.norm(tilt_turn))

        # 1: down to the grasp; 0: stay at this height; -1: up to where nothing stands.
        nearly = deep * beside * _ramp(0.05 - across, 0.01)
        down = min(
            _both(room - 0.002 - along, 0.006),
            max(_both(0.016 - across, 0.008), nearly - 1),
            max(_both(opening - width - 0.002, 0.008), 2 * around - 1),
            _ramp(0.35 - abs(yaw_error), 0.15),
            _ramp(0.25 - tilt, 0.1),
        )
        blocked = best_room < _LEAST_ROOM_M and around < 0.5
        if blocked:
            down = -1.0
        high = _ramp(height - (TRANSIT_HEIGHT_M - 0.05), 0.03)
        across_share = max(high, min(1.0, down + 1.0)) if not blocked else high
        twist = np.zeros(6)
        top = _FINE_M_S + (_TRANSIT_M_S - _FINE_M_S) * high
        twist[:2] = across_share * _capped(_GAIN_HZ * error[:2], top)
        if down >= 0:
            twist[2] = down * np.clip(_GAIN_HZ * error[2], -_DESCENT_M_S, 0.1)
        else:
            climb = _GAIN_HZ * (TRANSIT_HEIGHT_M - height)
            twist[2] = -down * np.clip(climb, -_CLIMB_M_S, _CLIMB_M_S)
        twist[3:] = _GAIN_HZ * tilt_turn
        twist[5] += _GAIN_HZ * yaw_error
        twist[3:] = _capped(twist[3:], _TURN_RAD_S)

        arrived = min(
            _ramp(0.010 - along, 0.004),
            _ramp(0.014 - across, 0.004),
            _ramp(0.020 - abs(error[2]), 0.008),
        )
        touching = around * _ramp(width + 0.02 - opening, 0.01)
        close = max(arrived, touching)
        pressing = _ramp(state.pressed_m - 0.008, 0.008)
        held = around * pressing * _ramp(width + 0.01 - opening, 0.004)
        grip = 2 * close - 1
        if close == 0.0 and not self._may_open(state):
            grip = self.closing.holding_grip(state.closed_m)
        if held > 0:
            lift = np.clip(_GAIN_HZ * (LIFT_HEIGHT_M - state.target_base_m[2]), -0.1, _LIFT_M_S)
            twist *= 1 - held
            twist[2] += held * lift
        # Something else is between the pads: it is set down before it is let go.
        wrong = pressing * (1 - around) * float(state.closed_m < self.closing.opening_m - 0.01)
        if wrong > 0:
            lowered = -np.clip(_GAIN_HZ * state.raised_m, 0.0, 0.1)
            twist *= 1 - wrong
            twist[2] += wrong * lowered * float(state.raised_m > 0.004)
            grip = 1.0 if state.raised_m > 0.012 else -1.0
        intent = _intent(held, wrong, close, down, blocked, height)
        return GraspCommand(twist, float(grip), intent, around, arrived)

    def _in_jaw(self, state: GraspState, error: NDArray) -> tuple[float, float]:
        """Horizontal distance of the goal from the pinch along the fingers' way, and across it."""
        way = state.tool_rotation[:2, 1]
        way = way / max(float(np.linalg.norm(way)), 1e-6)
        return abs(float(way @ error[:2])), abs(float(way[0] * error[1] - way[1] * error[0]))

    def _yaw_error(self, state: GraspState, goal: NDArray) -> tuple[float, float]:
        """The least turn about the vertical to where there is room, and the most room."""
        way = state.tool_rotation[:2, 1]
        now = float(np.arctan2(way[1], way[0]))
        rooms = self._rooms(state, goal[:2], goal[2], _YAWS_RAD)
        best = float(rooms.max())
        turns = (_YAWS_RAD - now + np.pi / 2) % np.pi - np.pi / 2
        # A jaw is the same when turned by half a turn.
        turns = np.concatenate([turns, turns - np.pi * np.sign(turns)])
        low, high = state.turn_range_rad
        fits = (np.tile(rooms, 2) >= min(_ROOM_M, best)) & (turns >= low) & (turns <= high)
        if not fits.any():
            return 0.0, best
        step = _YAWS_RAD[1]
        least = turns[fits][np.argmin(np.abs(turns[fits]))]
        # Between two admissible yaws of the grid is no error.
        return float(np.sign(least) * max(abs(least) - 0.75 * step, 0.0)), best

    def _rooms(
        self, state: GraspState, centre_m: NDArray, height_m: float, yaws_rad: NDArray
    ) -> NDArray[np.float64]:
        """(k,) room around the jaw at `centre_m` for each of (k,) yaws."""
        relative = state.outlines_m - centre_m
        rooms = np.full(len(yaws_rad), 1.0)
        near = np.abs(relative).max(axis=1, initial=0.0) < 0.15
        for foot in self.footprints:
            rising = near & (state.outline_heights_m > height_m + foot.above_tool_m)
            found = clearances(relative[rising], yaws_rad, foot.half_along_m, foot.half_across_m)
            rooms = np.minimum(rooms, found)
        return rooms

    def _may_open(self, state: GraspState) -> bool:
        """Whether opening where the jaw is pushes nothing."""
        way = state.tool_rotation[:2, 1]
        yaw = np.array([np.arctan2(way[1], way[0])])
        position = state.tool_position_m
        tip_room = self._rooms(state, position[:2], position[2], yaw)[0]
        beside = abs(float(np.linalg.norm(state.target_base_m[:2] - position[:2])))
        above_target = position[2] - _TIP_M > state.target_base_m[2] + state.target_height_m
        return tip_room > 0.002 and (above_target or beside > 0.11 or self._target_inside(state))

    def _target_inside(self, state: GraspState) -> bool:
        error = state.target_base_m - state.tool_position_m
        along, _ = self._in_jaw(state, error)
        return along < (self.closing.opening_m - state.closed_m) / 2


def _ramp(value: float, width: float) -> float:
    """0 below 0, 1 beyond `width`."""
    return float(np.clip(value / width, 0.0, 1.0))


def _both(value: float, width: float) -> float:
    """-1 below -width, 1 beyond `width`."""
    return float(np.clip(value / width, -1.0, 1.0))


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
