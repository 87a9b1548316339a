"""What the expert's law looks at, and what it answers."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray


class Intent(StrEnum):
    """The expert's intent: what it is about, for people.

    It follows from the state like the action.
    """

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
    leaning_rad: float = 0.0
    """how far the most tilted object of the clutter is from upright"""


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
