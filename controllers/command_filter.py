"""Predictive safety filter: it passes only commands after which the arm can still stop.

Limits that are held one step at a time collide: the joint that may not pass its end may not brake
that hard either. So the filter plans for it. Together with its command it keeps a stop, the joint
velocities of the coming control steps down to rest, that was found to hold every limit at every
step. A new command is admitted only if it holds them too and has such a stop of its own; if it has
none, less of it is taken, and if nothing of it can be had the arm takes the next step of the stop
that it keeps, whose rest is a stop again. It begins at rest, in a place that is admissible. By
induction no limit is ever exceeded, and no two of them ever contradict each other. This is the
recursive feasibility of model-predictive control, and what Wabersich and Zeilinger (2021) call a
predictive safety filter, with the stop in closed form (`Stopping`) in place of an optimisation.

What is limited is the command, at the control steps. The arm follows it with the error of its
servos, so clearances are chosen larger than that.
"""

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sheath_manip.controllers.joint_limits import JointLimits
from sheath_manip.controllers.speed_cap import SpeedCap
from sheath_manip.controllers.stopping import Stopping
from sheath_manip.controllers.workspace import Workspace
from sheath_manip.exceptions import ParameterError
from sheath_manip.types import Limited

MALFORMED = "malformed command"
SPEED = "joint speed"
ACCELERATION = "joint acceleration"
RANGE = "joint range"

_HALVINGS = 4
"""of the way between a command that is admissible and one that is not"""
_SLIDES = 6
"""walls that a command may slide along at once: a corner of the workspace, a jaw on the table"""
_OFF_WALL = 0.03
"""of what leads along a wall, to lead off it"""
_SWEEPS = 5
"""of projections onto the walls, of which one may lead into the other"""
_FARTHEST_RAD = 1e300
"""from which on a wish is no finite speed"""
_ROUNDING = 1e-9
"""rad/s, m/s: less is no change of a command"""
_TINY = 1e-12
"""rounding of sums of some ten numbers near 1"""


@dataclass(frozen=True, eq=False)
class Admitted:
    """What is commanded for one control step."""

    targets_rad: NDArray[np.float64]
    """(j,) of the joints at its end"""
    velocities_rad_s: NDArray[np.float64]
    """(j,) during it"""
    limited: tuple[Limited, ...]
    """the limits that changed the command, sorted by name; by how much: the largest change of a
    joint's velocity as a share of its top speed"""


@dataclass(frozen=True, eq=False)
class _Motion:
    """A step and the stop that could follow it."""

    rates: NDArray[np.float64]
    """(1 + n, j) velocities during the step, then during those of the stop, until it rests"""
    path: NDArray[np.float64]
    """(1 + n, j) where the joints are at their ends"""


@dataclass(frozen=True, eq=False)
class _Refusal:
    """Why a motion is not admitted."""

    limit: str
    inwards: NDArray[np.float64] | None
    """(j,) the way out, where there is one to slide along"""


class CommandFilter:
    """Holds an arm's command within all its limits, whichever arm it is.

    It remembers the command: `reset` starts it, and it goes on over any change of who acts, so that
    a hand-over is a change of command like any other.
    """

    def __init__(
        self,
        joints: JointLimits,
        timestep_s: float,
        workspace: Workspace | None = None,
        speed_cap: SpeedCap | None = None,
    ) -> None:
        """`timestep_s` is the control step. Raises ParameterError."""
        if speed_cap is not None and workspace is None:
            raise ParameterError("a speed cap without a workspace; wanted one, to know the tool")
        self.joints = joints
        self.timestep_s = timestep_s
        self.workspace = workspace
        self.speed_cap = speed_cap
        self.stopping = Stopping(joints, timestep_s)
        self._lower_rad, self._upper_rad = joints.lower_rad - _TINY, joints.upper_rad + _TINY
        self._speeds_rad_s = joints.speeds_rad_s + _TINY
        self._targets = np.full(len(joints.lower_rad), np.nan)
        self._rest()

    @property
    def targets_rad(self) -> NDArray[np.float64]:
        """(j,) commanded last."""
        return self._targets.copy()

    @property
    def velocities_rad_s(self) -> NDArray[np.float64]:
        """(j,) commanded last."""
        return self._velocities.copy()

    def reset(self, targets_rad: NDArray) -> None:
        """Start at rest; raises ParameterError where (j,) `targets_rad` is not admissible."""
        targets = np.array(targets_rad, np.float64)
        lower, upper = self.joints.lower_rad, self.joints.upper_rad
        if targets.shape != lower.shape or not ((targets >= lower) & (targets <= upper)).all():
            raise ParameterError(
                f"joints at {targets.tolist()}; wanted each in its range, {lower.tolist()} .. "
                f"{upper.tolist()}"
            )
        breach = None if self.workspace is None else self.workspace.breach(targets)
        if breach is not None:
            raise ParameterError(f"{breach.what}; wanted a start within the limits")
        self._targets = targets
        self._rest()

    def memory(self) -> NDArray[np.float64]:
        """(m,) all that it remembers; of the same size always."""
        rows = np.zeros((3 + self.stopping.steps, len(self._targets)))
        rows[:3] = self._targets, self._changes, self._velocities
        rows[3 : 3 + len(self._stop)] = self._stop
        return rows.ravel()

    def recall(self, memory: NDArray[np.float64]) -> None:
        """Take over a `memory()`."""
        rows = np.array(memory, np.float64).reshape(-1, len(self._targets))
        self._targets, self._changes, self._velocities = rows[:3]
        self._stop = _until_rest(rows[3:])

    def step(self, wished_targets_rad: ArrayLike) -> Admitted:
        """What is commanded for a control step at whose end the joints were wished to be there.

        Whatever is no (j,) finite number brings the arm to rest.
        """
        taken: dict[str, float] = {}
        wish = self._well_formed(wished_targets_rad)
        if wish is None:
            taken[MALFORMED] = 1.0
            wish = np.zeros_like(self._targets)
        wish = self._slowed(wish, taken)
        motion = self._placed(wish, taken)
        self._changes = motion.rates[0] - self._velocities
        self._targets = motion.path[0]
        self._velocities, self._stop = motion.rates[0], motion.rates[1:]
        limited = tuple(Limited(*item) for item in sorted(taken.items()))
        return Admitted(self.targets_rad, self.velocities_rad_s, limited)

    def _rest(self) -> None:
        still = np.zeros_like(self._targets)
        self._changes = self._velocities = still
        self._stop = np.zeros((0, len(still)))

    def _well_formed(self, wished_targets_rad: ArrayLike) -> NDArray[np.float64] | None:
        """(j,) velocities that are wished, rad/s."""
        try:
            wished = np.asarray(wished_targets_rad, np.float64)
        except (TypeError, ValueError):
            return None
        if wished.shape != self._targets.shape or not (np.abs(wished) < _FARTHEST_RAD).all():
            return None
        return (wished - self._targets) / self.timestep_s

    def _slowed(self, wish: NDArray, taken: dict[str, float]) -> NDArray[np.float64]:
        """`wish` along the same way, no faster than joints, and tool where it is, may be."""
        slowed = wish
        speed = float((np.abs(wish) / self.joints.speeds_rad_s).max())
        if speed > 1.0:
            slowed = wish / speed
            self._note(SPEED, wish, slowed, taken)
        if self.speed_cap is None or self.workspace is None:
            return slowed
        here = self.workspace.tool_position_m(self._targets)
        most = self.speed_cap.most_m_s(here)
        there = self.workspace.tool_position_m(self._targets + slowed * self.timestep_s)
        tool_speed = math.dist(here, there) / self.timestep_s
        if tool_speed <= most:
            return slowed
        careful = slowed * (most / tool_speed)
        self._note(self.speed_cap.name, slowed, careful, taken)
        return careful

    def _placed(self, wish: NDArray, taken: dict[str, float]) -> _Motion:
        """The motion nearest to `wish` that is found to hold all limits, with its stop."""
        asked = self._reached(wish, taken)
        refusal = self._refusal(asked)
        if refusal is None:
            return asked
        admitted = self._going_on()
        admitted_wish, refused_wish = admitted.rates[0], wish
        names, walls = set[str](), list[NDArray]()
        for _ in range(_SLIDES):
            names.add(refusal.limit)
            if refusal.inwards is None:
                break
            walls.append(refusal.inwards)
            slid = self._along(np.array(walls), wish)
            motion = self._reached(slid)
            refusal = self._refusal(motion)
            if refusal is None:
                admitted_wish, admitted = slid, motion
                break
            refused_wish = slid
        for _ in range(_HALVINGS):
            middle = (admitted_wish + refused_wish) / 2
            motion = self._reached(middle)
            if self._refusal(motion) is None:
                admitted_wish, admitted = middle, motion
            else:
                refused_wish = middle
        for name in names:
            self._note(name, asked.rates[0], admitted.rates[0], taken)
        return admitted

    def _reached(self, wish: NDArray, taken: dict[str, float] | None = None) -> _Motion:
        """The step towards `wish` that the joints' own limits admit, and its stop."""
        now = self._velocities
        # To change to another velocity is to stop, seen from that velocity.
        changes = self.stopping.changes(now - wish, self._changes)
        if changes is not None and len(changes) == 1:
            wanted = wish
        else:
            wanted = self._going_on().rates[0] if changes is None else now + changes[0]
            if taken is not None:
                self._note(ACCELERATION, wish, wanted, taken)
        motion, holds = self._with_stop(wanted)
        if holds.all():
            return motion
        motion = self._towards(wanted)
        if taken is not None:
            self._note(RANGE, wanted, motion.rates[0], taken)
        return motion

    def _towards(self, wanted: NDArray) -> _Motion:
        """As much of the way to (j,) `wanted` as each joint's own limits admit, and the stop.

        A joint that finds none takes the next step of the stop that is kept.
        """
        kept = self._padded(self._going_on().rates)
        rates = kept
        admitted, refused = np.zeros_like(wanted), np.ones_like(wanted)
        share = refused
        for _ in range(1 + _HALVINGS):
            tried, held = self._with_stop(kept[0] + share * (wanted - kept[0]))
            holds = held.all(axis=0)
            rates = np.where(holds, self._padded(tried.rates), rates)
            admitted = np.where(holds, share, admitted)
            refused = np.where(holds, refused, share)
            share = np.where(admitted == 1.0, 1.0, (admitted + refused) / 2)
        return self._motion(np.concatenate([rates[:1], _until_rest(rates[1:])]))

    def _with_stop(self, velocities: NDArray) -> tuple[_Motion, NDArray[np.bool_]]:
        """A step of (j,) `velocities` with its stop, and (1 + n, j) where joints hold limits."""
        changes = self.stopping.changes(velocities, velocities - self._velocities)
        if changes is None:
            return self._going_on(), np.zeros((1, len(velocities)), bool)
        rates = velocities[None]
        # The last change is the one to rest.
        if len(changes) > 1:
            stop = velocities + changes[:-1].cumsum(axis=0)
            stop[np.abs(stop) < _TINY] = 0.0
            rates = np.concatenate([rates, stop])
        motion = self._motion(rates)
        holds = (motion.path >= self._lower_rad) & (motion.path <= self._upper_rad)
        return motion, holds & (np.abs(rates) <= self._speeds_rad_s)

    def _going_on(self) -> _Motion:
        """The next step of the stop that is kept."""
        return self._motion(self._stop if len(self._stop) else np.zeros((1, len(self._targets))))

    def _motion(self, rates: NDArray) -> _Motion:
        """From where the joints are commanded now."""
        return _Motion(rates, self._targets + rates.cumsum(axis=0) * self.timestep_s)

    def _padded(self, rates: NDArray) -> NDArray[np.float64]:
        """(1 + N, j) with rest up to the last step that a stop may take."""
        padded = np.zeros((1 + self.stopping.steps, rates.shape[1]))
        padded[: len(rates)] = rates
        return padded

    def _refusal(self, motion: _Motion) -> _Refusal | None:
        """The first limit of the whole arm that `motion` or its stop would exceed."""
        if self.workspace is None:
            return None
        for positions in motion.path:
            breach = self.workspace.breach(positions)
            if breach is not None:
                return _Refusal(breach.limit, breach.inwards)
        if self.speed_cap is not None:
            points = [self.workspace.tool_position_m(q) for q in (self._targets, *motion.path)]
            for before, after in pairwise(points):
                speed = math.dist(before, after) / self.timestep_s
                if speed > self.speed_cap.most_m_s(after) + _ROUNDING:
                    return _Refusal(self.speed_cap.name, None)
        return None

    def _along(self, walls: NDArray, wish: NDArray) -> NDArray[np.float64]:
        """`wish` without what leads into (w, j) `walls`, given by the ways out of them.

        A wall is curved in the space of joints, so what leads along it must lead off it a little.
        """
        ways = walls * self.joints.speeds_rad_s
        ways /= np.maximum(np.linalg.norm(ways, axis=1, keepdims=True), _TINY)
        shares = wish / self.joints.speeds_rad_s
        for off in (0.0, _OFF_WALL):
            least = off * float(np.linalg.norm(shares))
            for way in np.tile(ways, (_SWEEPS, 1)):
                shares = shares + way * max(0.0, least - float(way @ shares))
        return shares * self.joints.speeds_rad_s

    def _note(self, limit: str, before: NDArray, after: NDArray, taken: dict[str, float]) -> None:
        changed = np.abs(after - before)
        if (changed > _ROUNDING).any():
            taken[limit] = float((changed / self.joints.speeds_rad_s).max())


def _until_rest(stop: NDArray[np.float64]) -> NDArray[np.float64]:
    """(n, j) of (N, j) velocities without the zeros at their end."""
    moving = np.flatnonzero(stop.any(axis=1))
    return stop[: moving[-1] + 1] if len(moving) else stop[:0]
