"""How joints come to rest, or to another velocity, with bounded acceleration and jerk."""

import math

import numpy as np
from numpy.typing import NDArray

from sheath_manip.controllers.joint_limits import JointLimits

_TOLERANCE = 1e-12
"""rounding of sums of some ten numbers near 1"""


class Stopping:
    """The quickest stop of each joint, in control steps of one length.

    Velocities change at control steps only. A change of velocity (rad/s) is bounded by the
    acceleration, and its difference to the change before by the jerk. A stop in n steps is a
    sequence of n changes that add up to minus the velocity, begin within the jerk of the last
    change, and end within the jerk of none. All such sequences lie between a lowest and a highest
    one, which are known in closed form, and any mixture of the two is one as well: so n steps will
    do exactly if the velocity lies between the two sums, and the mixture that hits it is the stop.
    """

    def __init__(self, limits: JointLimits, timestep_s: float) -> None:
        self.most_change = limits.accelerations_rad_s2 * timestep_s
        """(j,) rad/s from a control step to the next"""
        self.most_jerk = limits.jerks_rad_s3 * timestep_s**2
        """(j,) rad/s by which a change may differ from the one before"""
        # From one top speed to the other, with the wrong acceleration in full at the start.
        onset = math.ceil(float((self.most_change / self.most_jerk).max()))
        full = math.ceil(float((2 * limits.speeds_rad_s / self.most_change).max()))
        self.steps = full + 3 * onset + 1
        """N, within which any change between admissible velocities can be made"""
        count = np.arange(1, self.steps + 1)
        self._grown = count[:, None] * self.most_jerk
        left = np.maximum(count[:, None] + 1 - count, 0)
        self._left = left[..., None] * self.most_jerk
        most = np.minimum(self.most_change, self.most_jerk)
        self._one_step = -most, most
        self._joints = np.arange(len(self.most_change))

    def changes(self, velocities: NDArray, last_changes: NDArray) -> NDArray[np.float64] | None:
        """(n, j) changes that bring (j,) `velocities` (rad/s) to zero, in as few steps as will do.

        `last_changes` are those that led to `velocities`. None where N steps do not suffice.
        """
        # Most motions can be stopped in one step, and the rest takes ten times as long.
        low = np.maximum(self._one_step[0], last_changes - self.most_jerk)
        high = np.minimum(self._one_step[1], last_changes + self.most_jerk)
        if ((low <= -velocities) & (-velocities <= high)).all():
            return -velocities[None]
        # By the number of steps that the stop takes, by step, by joint.
        highest = np.minimum(np.minimum(self._left, self.most_change), last_changes + self._grown)
        lowest = np.maximum(np.maximum(-self._left, -self.most_change), last_changes - self._grown)
        most, least = highest.sum(1), lowest.sum(1)
        enough = (least <= _TOLERANCE - velocities) & (-velocities <= most + _TOLERANCE)
        enough &= (lowest <= highest + _TOLERANCE).all(1)
        if not enough.any(0).all():
            return None
        number = enough.argmax(0)
        least, most = least[number, self._joints], most[number, self._joints]
        span = np.maximum(most - least, _TOLERANCE)
        share = np.clip((-velocities - least) / span, 0.0, 1.0)
        low, high = lowest[number, :, self._joints].T, highest[number, :, self._joints].T
        return (low + share * (high - low))[: number.max() + 1]
