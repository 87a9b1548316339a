"""What the core is told about a task: its actions, its time, what it shows."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ActionError

Action = NDArray[np.float32]
"""(a,) what is commanded for one control step, in the units of the task's `ActionSpec`."""


@dataclass(frozen=True, eq=False)
class ActionSpec:
    """The space that policy, expert and person share."""

    names: tuple[str, ...]
    """one per dimension, each ending in its unit, such as `steering_rad`"""
    minimum: NDArray[np.float32]
    """(a,)"""
    maximum: NDArray[np.float32]
    """(a,)"""
    choices: NDArray[np.float32] | None = None
    """(k, a) the admissible actions where the space is discrete"""
    tolerance: float = 0.0
    """by which share of its range each dimension of two actions may differ and they still count as
    the same; 0 where the space is discrete"""

    @property
    def span(self) -> NDArray[np.float32]:
        """(a,) what a dimension's bounds are apart; 1 for one that is fixed, so that it divides."""
        apart = self.maximum - self.minimum
        return np.where(apart > 0, apart, np.ones_like(apart))

    def validated(self, action: Any) -> Action:
        """Return `action` as (a,) float32, or raise ActionError naming what is wrong with it."""
        try:
            array = np.asarray(action, dtype=np.float32)
        except (TypeError, ValueError) as error:
            raise ActionError(f"action {action!r} is no array of numbers") from error
        if array.shape != self.minimum.shape:
            raise ActionError(
                f"action has shape {array.shape}; wanted {self.minimum.shape} "
                f"({', '.join(self.names)})"
            )
        # Not a number is not inside either.
        inside = (array >= self.minimum - 1e-6) & (array <= self.maximum + 1e-6)
        if not inside.all():
            if not np.isfinite(array).all():
                raise ActionError(
                    f"action is not finite: {array.tolist()} ({', '.join(self.names)})"
                )
            raise ActionError(
                f"action {array.tolist()} leaves its bounds "
                f"{self.minimum.tolist()} .. {self.maximum.tolist()} ({', '.join(self.names)})"
            )
        return array


@dataclass(frozen=True)
class FirstView:
    """How viewers look at a task's tool before a person turns the view."""

    radius_m: float
    """around the tool, that is seen"""
    azimuth_deg: float
    """of the way in which the camera looks, from +x towards +y"""
    elevation_deg: float
    """above the horizon, of where the camera is"""
    follows: bool = False
    """whether the view goes along with the tool"""


@dataclass(frozen=True)
class Mirror:
    """A reflection after which the task is what it was, with every camera's image flipped."""

    features: tuple[float, ...]
    """(f,) 1 or -1: the sign that each feature takes on"""
    action: tuple[float, ...]
    """(a,) 1 or -1: the sign that each dimension of an action takes on"""


@dataclass(frozen=True, eq=False)
class ToolFrame:
    """The frame of a tool that moves in a plane which a camera sees, turned as the tool heads."""

    camera: str
    px_of_plane: NDArray[np.float64]
    """(3, 3) homography: (x, y, 1) in the plane, metres in the world frame, to (column, row, 1) of
    the image, up to a factor"""
    position: tuple[str, str]
    """features: x and y of the tool"""
    heading: tuple[str, str]
    """features: cosine and sine of the way it heads, from x towards y"""
    vector: tuple[str, str] | tuple[()]
    """dimensions of an action that are the x and y of a vector in the world frame; empty where none
    are"""


@dataclass(frozen=True)
class TaskSpec:
    """What the core is told about a task."""

    name: str
    control_rate_hz: float
    action: ActionSpec
    cameras: Mapping[str, tuple[int, int]]
    """(height, width) in pixels, by camera"""
    feature_names: tuple[str, ...]
    """the entries of `Observation.features`, each ending in its unit"""
    max_steps: int
    """the time limit, in control steps"""
    metric: str
    """the entry of `Episode.metrics` by which the task is judged; more is better"""
    plane: tuple[str, str] | None = None
    """the two features that span the task's natural plane (metres), where it has one"""
    first_view: FirstView | None = None
    """None: the whole scene, from above"""
    mirror: Mirror | None = None
    """left for right, where robot, cameras and scenes know no difference"""
    tool_frame: ToolFrame | None = None
    """from which the task looks the same wherever the tool is"""
