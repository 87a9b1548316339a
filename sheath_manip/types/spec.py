"""What the core is told about a task: its actions, its time, what it shows."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ActionError

Action = NDArray[np.float32]
"""(a,) what is commanded for one control step, in the units of the task's `ActionSpec`."""

ROUNDING = 1e-6
"""by which an action in float32 may leave a bound, in the action's unit"""


def real_numbers(values: Any) -> NDArray[np.float32]:
    """Return a new float32 array of real numbers; raises ActionError for anything else.

    Text, bytes, truth values, complex numbers, masked and structured arrays, objects and tensors
    that cannot be converted are no numbers, though numpy would make some of them.
    """
    if type(values) is np.ndarray and values.dtype == np.float32:
        return values.copy()
    try:
        array = np.asarray(values)
        masked = isinstance(values, np.ma.MaskedArray) or any(
            isinstance(each, np.ma.MaskedArray) for each in _members(values)
        )
        if array.dtype.kind in "fiu" and not masked:
            # What float32 cannot hold becomes infinite, which is told of as not finite.
            with np.errstate(over="ignore"):
                return np.array(array, np.float32)
    except Exception as error:
        # A tensor that wants its gradient, an `__array__` of somebody's own: they raise anything.
        raise ActionError(
            f"action of type {type(values).__name__} is no array of numbers "
            f"({type(error).__name__})"
        ) from error
    kind = "a masked array" if masked else f"of {array.dtype.name}"
    raise ActionError(f"action is no array of real numbers, but {kind}")


def _members(values: Any) -> Iterable[Any]:
    return values if isinstance(values, list | tuple) else ()


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
    choice_words: tuple[str, ...] = ()
    """k, each of the choices as a person says it, such as `go left`; empty where nobody said"""

    @property
    def span(self) -> NDArray[np.float32]:
        """(a,) what a dimension's bounds are apart; 1 for one that is fixed, so that it divides."""
        apart = self.maximum - self.minimum
        return np.where(apart > 0, apart, np.ones_like(apart))

    def validated(self, action: Any) -> Action:
        """Return `action` as (a,) float32, or raise ActionError naming what is wrong with it.

        The array is new, within the bounds to the bit, and cannot be written to. What leaves a
        bound by no more than rounding does, `ROUNDING`, is put onto it.
        """
        array = real_numbers(action)
        if array.shape != self.minimum.shape:
            raise ActionError(
                f"action has shape {array.shape}; wanted {self.minimum.shape} "
                f"({', '.join(self.names)})"
            )
        # Not a number is not inside either.
        if not ((array >= self.minimum) & (array <= self.maximum)).all():
            array = self._rounded(array)
        array.flags.writeable = False
        return array

    def _rounded(self, array: Action) -> Action:
        """Put onto its bounds what leaves them by rounding; raises ActionError for the rest."""
        if not np.isfinite(array).all():
            raise ActionError(f"action is not finite: {array.tolist()} ({', '.join(self.names)})")
        inside = (array >= self.minimum - ROUNDING) & (array <= self.maximum + ROUNDING)
        if not inside.all():
            raise ActionError(
                f"action {array.tolist()} leaves its bounds "
                f"{self.minimum.tolist()} .. {self.maximum.tolist()} ({', '.join(self.names)})"
            )
        return np.clip(array, self.minimum, self.maximum)


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
