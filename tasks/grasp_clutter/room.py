"""How much room the clutter leaves a jaw that points down, and how it is best turned."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sheath_manip.controllers.footprint import clearances
from sheath_manip.tasks.grasp_clutter.grasp_state import GraspState
from sheath_manip.tasks.robots.robot import Footprint

_NEAR_M = 0.15
"""beyond which nothing is in a jaw's way"""
_YAWS_RAD = np.linspace(0, np.pi, 60, endpoint=False)


@dataclass(frozen=True)
class JawRoom:
    """The room around one tool's footprints."""

    footprints: tuple[Footprint, ...]
    wanted_m: float
    """around the jaw: with less it turns"""

    def here(self, state: GraspState) -> float:
        """Return the room around the jaw as it stands, m."""
        position = state.tool_position_m
        return float(self._rooms(state, position, np.array([_yaw(state)]))[0])

    def least_turn(self, state: GraspState, goal_m: NDArray) -> tuple[float, float]:
        """Return how far to turn the jaw (rad, about the vertical) for room at (3,) `goal_m`.

        And the most room (m) that it can have there, turned by any angle.
        """
        rooms = self._rooms(state, goal_m, _YAWS_RAD)
        best = float(rooms.max())
        turns = (_YAWS_RAD - _yaw(state) + np.pi / 2) % np.pi - np.pi / 2
        # A jaw is the same when turned by half a turn.
        turns = np.concatenate([turns, turns - np.pi * np.sign(turns)])
        low, high = state.turn_range_rad
        fits = (np.tile(rooms, 2) >= min(self.wanted_m, best)) & (turns >= low) & (turns <= high)
        if not fits.any():
            return 0.0, best
        least = turns[fits][np.argmin(np.abs(turns[fits]))]
        # Between two admissible yaws of the grid is no error.
        return float(np.sign(least) * max(abs(least) - 0.75 * _YAWS_RAD[1], 0.0)), best

    def _rooms(
        self, state: GraspState, centre_m: NDArray, yaws_rad: NDArray
    ) -> NDArray[np.float64]:
        """(k,) with the jaw at (3,) `centre_m`, turned to each of (k,) yaws."""
        relative = state.outlines_m - centre_m[:2]
        rooms = np.full(len(yaws_rad), 1.0)
        near = np.abs(relative).max(axis=1, initial=0.0) < _NEAR_M
        for foot in self.footprints:
            rising = near & (state.outline_heights_m > centre_m[2] + foot.above_tool_m)
            found = clearances(relative[rising], yaws_rad, foot.half_along_m, foot.half_across_m)
            rooms = np.minimum(rooms, found)
        return rooms


def _yaw(state: GraspState) -> float:
    """Of the way that the fingers move."""
    x, y = state.tool_rotation[:2, 1]
    return float(np.arctan2(y, x))
