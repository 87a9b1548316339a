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
from sheath_manip.controllers.motions import (
    HALVINGS,
    TINY,
    Kept,
    Motion,
    Motions,
    at_rest,
    until_rest,
)
from sheath_manip.controllers.speed_cap import SpeedCap
from sheath_manip.controllers.workspace import Workspace
from sheath_manip.exceptions import ParameterError
from sheath_manip.types import Limited

MALFORMED = "malformed command"
SPEED = "joint speed"
ACCELERATION = "joint acceleration"
RANGE = "joint range"

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
        self._motions = Motions(joints, timestep_s)
        self.stopping = self._motions.stopping
        self._kept = at_rest(np.full(len(joints.lower_rad), np.nan))

    @property
    def targets_rad(self) -> NDArray[np.float64]:
        """(j,) commanded last."""
        return self._kept.targets_rad.copy()

    @property
    def velocities_rad_s(self) -> NDArray[np.float64]:
        """(j,) commanded last."""
        return self._kept.velocities_rad_s.copy()

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
        self._kept = at_rest(targets)

    def memory(self) -> NDArray[np.float64]:
        """(m,) all that it remembers; of the same size always."""
        kept = self._kept
        rows = np.zeros((3 + self.stopping.steps, len(kept.targets_rad)))
        rows[:3] = kept.targets_rad, kept.changes_rad_s, kept.velocities_rad_s
        rows[3 : 3 + len(kept.stop_rad_s)] = kept.stop_rad_s
        return rows.ravel()

    def recall(self, memory: NDArray[np.float64]) -> None:
        """Take over a `memory()`."""
        rows = np.array(memory, np.float64).reshape(-1, len(self._kept.targets_rad))
        targets, changes, velocities = rows[:3]
        self._kept = Kept(targets, velocities, changes, until_rest(rows[3:]))

    def step(self, wished_targets_rad: ArrayLike) -> Admitted:
        """What is commanded for a control step at whose end the joints were wished to be there.

        Whatever is no (j,) finite number brings the arm to rest.
        """
        taken: dict[str, float] = {}
        wish = self._well_formed(wished_targets_rad)
        if wish is None:
            taken[MALFORMED] = 1.0
            wish = np.zeros_like(self._kept.targets_rad)
        wish = self._slowed(wish, taken)
        motion = self._placed(wish, taken)
        changes = motion.rates[0] - self._kept.velocities_rad_s
        self._kept = Kept(motion.path[0], motion.rates[0], changes, motion.rates[1:])
        limited = tuple(Limited(*item) for item in sorted(taken.items()))
        return Admitted(self.targets_rad, self.velocities_rad_s, limited)

    def _well_formed(self, wished_targets_rad: ArrayLike) -> NDArray[np.float64] | None:
        """(j,) velocities that are wished, rad/s."""
        try:
            wished = np.asarray(wished_targets_rad, np.float64)
        except (TypeError, ValueError):
            return None
        targets = self._kept.targets_rad
        if wished.shape != targets.shape or not (np.abs(wished) < _FARTHEST_RAD).all():
            return None
        return (wished - targets) / self.timestep_s

    def _slowed(self, wish: NDArray, taken: dict[str, float]) -> NDArray[np.float64]:
        """`wish` along the same way, no faster than joints, and tool where it is, may be."""
        slowed = wish
        speed = float((np.abs(wish) / self.joints.speeds_rad_s).max())
        if speed > 1.0:
            slowed = wish / speed
            self._note(SPEED, wish, slowed, taken)
        if self.speed_cap is None or self.workspace is None:
            return slowed
        targets = self._kept.targets_rad
        here = self.workspace.tool_position_m(targets)
        most = self.speed_cap.most_m_s(here)
        there = self.workspace.tool_position_m(targets + slowed * self.timestep_s)
        tool_speed = math.dist(here, there) / self.timestep_s
        if tool_speed <= most:
            return slowed
        careful = slowed * (most / tool_speed)
        self._note(self.speed_cap.name, slowed, careful, taken)
        return careful

    def _placed(self, wish: NDArray, taken: dict[str, float]) -> Motion:
        """The motion nearest to `wish` that is found to hold all limits, with its stop."""
        asked = self._reached(wish, taken)
        refusal = self._refusal(asked)
        if refusal is None:
            return asked
        admitted = self._motions.going_on(self._kept)
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
        for _ in range(HALVINGS):
            middle = (admitted_wish + refused_wish) / 2
            motion = self._reached(middle)
            if self._refusal(motion) is None:
                admitted_wish, admitted = middle, motion
            else:
                refused_wish = middle
        for name in names:
            self._note(name, asked.rates[0], admitted.rates[0], taken)
        return admitted

    def _reached(self, wish: NDArray, taken: dict[str, float] | None = None) -> Motion:
        """The step towards `wish` that the joints' own limits admit, and its stop."""
        kept = self._kept
        now = kept.velocities_rad_s
        # To change to another velocity is to stop, seen from that velocity.
        changes = self.stopping.changes(now - wish, kept.changes_rad_s)
        if changes is not None and len(changes) == 1:
            wanted = wish
        else:
            wanted = self._motions.going_on(kept).rates[0] if changes is None else now + changes[0]
            if taken is not None:
                self._note(ACCELERATION, wish, wanted, taken)
        motion, holds = self._motions.with_stop(kept, wanted)
        if holds.all():
            return motion
        motion = self._motions.towards(kept, wanted)
        if taken is not None:
            self._note(RANGE, wanted, motion.rates[0], taken)
        return motion

    def _refusal(self, motion: Motion) -> _Refusal | None:
        """The first limit of the whole arm that `motion` or its stop would exceed."""
        if self.workspace is None:
            return None
        for positions in motion.path:
            breach = self.workspace.breach(positions)
            if breach is not None:
                return _Refusal(breach.limit, breach.inwards)
        if self.speed_cap is not None:
            targets = (self._kept.targets_rad, *motion.path)
            points = [self.workspace.tool_position_m(q) for q in targets]
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
        ways /= np.maximum(np.linalg.norm(ways, axis=1, keepdims=True), TINY)
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
