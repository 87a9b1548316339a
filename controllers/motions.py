"""Motions of joints within their own limits: a control step, and the stop that could follow it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sheath_manip.controllers.joint_limits import JointLimits
from sheath_manip.controllers.stopping import Stopping

HALVINGS = 4
"""of the way between a command that is admissible and one that is not"""
TINY = 1e-12
"""rounding of sums of some ten numbers near 1"""


@dataclass(frozen=True, eq=False)
class Kept:
    """What is remembered of a command, at the end of its control step."""

    targets_rad: NDArray[np.float64]
    """(j,) of the joints"""
    velocities_rad_s: NDArray[np.float64]
    """(j,) during the step"""
    changes_rad_s: NDArray[np.float64]
    """(j,) of the velocities, from the step before"""
    stop_rad_s: NDArray[np.float64]
    """(n, j) velocities of the stop that was found to hold every limit, until it rests"""


@dataclass(frozen=True, eq=False)
class Motion:
    """A step and the stop that could follow it."""

    rates: NDArray[np.float64]
    """(1 + n, j) velocities during the step, then during those of the stop, until it rests"""
    path: NDArray[np.float64]
    """(1 + n, j) where the joints are at their ends"""


class Motions:
    """Finds motions that go on from a command and hold each joint's own limits."""

    def __init__(self, joints: JointLimits, timestep_s: float) -> None:
        """`timestep_s` is the control step."""
        self.timestep_s = timestep_s
        self.stopping = Stopping(joints, timestep_s)
        self._lower_rad, self._upper_rad = joints.lower_rad - TINY, joints.upper_rad + TINY
        self._speeds_rad_s = joints.speeds_rad_s + TINY

    def towards(self, kept: Kept, wanted: NDArray) -> Motion:
        """As much of the way to (j,) `wanted` as each joint's own limits admit, and the stop.

        A joint that finds none takes the next step of the stop that is kept.
        """
        going_on = self._padded(self.going_on(kept).rates)
        rates = going_on
        admitted, refused = np.zeros_like(wanted), np.ones_like(wanted)
        share = refused
        for _ in range(1 + HALVINGS):
            tried, held = self.with_stop(kept, going_on[0] + share * (wanted - going_on[0]))
            holds = held.all(axis=0)
            rates = np.where(holds, self._padded(tried.rates), rates)
            admitted = np.where(holds, share, admitted)
            refused = np.where(holds, refused, share)
            share = np.where(admitted == 1.0, 1.0, (admitted + refused) / 2)
        return self._motion(kept, np.concatenate([rates[:1], until_rest(rates[1:])]))

    def with_stop(self, kept: Kept, velocities: NDArray) -> tuple[Motion, NDArray[np.bool_]]:
        """A step of (j,) `velocities` with its stop, and (1 + n, j) where joints hold limits."""
        changes = self.stopping.changes(velocities, velocities - kept.velocities_rad_s)
        if changes is None:
            return self.going_on(kept), np.zeros((1, len(velocities)), bool)
        rates = velocities[None]
        # The last change is the one to rest.
        if len(changes) > 1:
            stop = velocities + changes[:-1].cumsum(axis=0)
            stop[np.abs(stop) < TINY] = 0.0
            rates = np.concatenate([rates, stop])
        motion = self._motion(kept, rates)
        holds = (motion.path >= self._lower_rad) & (motion.path <= self._upper_rad)
        return motion, holds & (np.abs(rates) <= self._speeds_rad_s)

    def going_on(self, kept: Kept) -> Motion:
        """The next step of the stop that is kept."""
        stop = kept.stop_rad_s
        return self._motion(kept, stop if len(stop) else np.zeros((1, stop.shape[1])))

    def _motion(self, kept: Kept, rates: NDArray) -> Motion:
        """From where the joints are commanded now."""
        return Motion(rates, kept.targets_rad + rates.cumsum(axis=0) * self.timestep_s)

    def _padded(self, rates: NDArray) -> NDArray[np.float64]:
        """(1 + N, j) with rest up to the last step that a stop may take."""
        padded = np.zeros((1 + self.stopping.steps, rates.shape[1]))
        padded[: len(rates)] = rates
        return padded


def at_rest(targets_rad: NDArray[np.float64]) -> Kept:
    """What is kept of a command that stands still, the joints at (j,) `targets_rad`."""
    still = np.zeros_like(targets_rad)
    return Kept(targets_rad, still, still, np.zeros((0, len(still))))


def until_rest(stop: NDArray[np.float64]) -> NDArray[np.float64]:
    """(n, j) of (N, j) velocities without the zeros at their end."""
    moving = np.flatnonzero(stop.any(axis=1))
    return stop[: moving[-1] + 1] if len(moving) else stop[:0]
