"""The small frozen values that cross every boundary of the framework."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ActionError

Action = NDArray[np.float32]
"""(a,) what is commanded for one control step, in the units of the task's `ActionSpec`."""


class Actor(StrEnum):
    """Who drives a control step."""

    POLICY = "policy"
    EXPERT = "expert"


class Reason(StrEnum):
    """Why a gate chose its actor."""

    FIXED = "fixed"
    """the gate always says so, or its schedule does"""
    DRAWN = "drawn"
    """a random draw decided"""
    INSIDE = "inside support"
    OUTSIDE = "outside support"
    RISK = "in-support risk"
    """the state is familiar, but not what the policy would do in it"""
    HOLD = "held by hysteresis"
    """inside again, but not yet far or long enough to hand back"""
    PERSON = "person"
    """a person said so"""
    NO_SCORE = "no score"
    """the score is missing or not a number: as outside"""
    INVALID_PROPOSAL = "invalid proposal"
    """the policy proposed an action that is no action: the expert acts"""
    WAITING = "waiting for person"
    """the robot holds until a person takes over, or the wait is over"""
    IDLE = "person idle"
    """a person has taken over and holds no device: the robot holds"""
    NO_ANSWER = "nobody answered"
    """the wait for a person is over: whoever stands in for it acts"""
    EMERGENCY_STOP = "emergency stop"
    """somebody stopped the robot, and nobody has reset it yet"""


class Outcome(StrEnum):
    """How an episode ended, in the task's own terms."""

    SUCCESS = "success"
    FAILURE = "failure"
    TIME_LIMIT = "time-limit"


class Purpose(StrEnum):
    """What an episode was recorded for; episodes of different purposes never share a seed."""

    DEMONSTRATION = "demonstration"
    CALIBRATION = "calibration"
    LEARNING = "learning"
    EVALUATION = "evaluation"


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
    """(a,) likewise of each dimension of an action"""


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


@dataclass(frozen=True, eq=False)
class Observation:
    """What is seen at one control step."""

    images: Mapping[str, NDArray[np.uint8]]
    """(h, w, 3) RGB by camera"""
    features: NDArray[np.float32]
    """(f,) in the order of `TaskSpec.feature_names`"""
    time_s: float


@dataclass(frozen=True)
class GateDecision:
    """Who acts, and whether the expert is asked for a label: two separate outputs of a gate."""

    actor: Actor
    query: bool
    """ask the expert for a label even though the policy may act"""
    reason: Reason
    score: float = float("nan")
    """support score, positive inside; NaN where the gate computes none"""
    threshold: float = float("nan")
    """the score below which the expert takes over; NaN where the gate has none"""


@dataclass(frozen=True, order=True)
class Limited:
    """A limit of the command filter that changed a command."""

    limit: str
    """such as `joint velocity`; a step names each at most once"""
    by: float
    """how much it took off, as a share of the fastest command; more than 0"""


@dataclass(frozen=True, eq=False)
class Commanded:
    """What became of an action on its way through a command filter."""

    action: Action
    """what was commanded in the end"""
    limited: tuple[Limited, ...] = ()
    """the limits that acted, sorted by name"""


@dataclass(frozen=True, eq=False)
class Step:
    """One control step, as recorded."""

    observation: Observation
    """before the action"""
    state: NDArray[np.float64]
    """(s,) simulator state before the action, for replay"""
    proposed: Action | None
    """what the policy wanted"""
    labelled: Action | None
    """what the expert would do, where it was asked or acted"""
    decision: GateDecision
    executed: Action
    """what was commanded: the action of who acts, after the command filter where there is one"""
    reward: float
    limited: tuple[Limited, ...] = ()
    """the limits of the command filter that acted, sorted by name"""

    @property
    def label(self) -> Action | None:
        """What to learn from: the expert's answer where a label was asked for.

        Who only holds the robot in an expert's place acts, and teaches nothing.
        """
        return self.labelled if self.decision.query else None

    @property
    def wished(self) -> Action:
        """What who acted wanted: given to the environment, it runs the step again to the bit."""
        wish = self.labelled if self.decision.actor is Actor.EXPERT else self.proposed
        return self.executed if wish is None else wish


@dataclass(frozen=True)
class EpisodeInfo:
    """Where an episode comes from: enough to run it again."""

    task: str
    seed: int
    """of the scene"""
    purpose: Purpose
    control_rate_hz: float
    method: str = ""
    round: int = 0
    index: int = 0
    """within its round"""
    run_seed: int = 0
    """of the training run it belongs to"""
    checkpoint: str = ""
    """content hash of the policy and gate that drove it; empty where none did"""


@dataclass(frozen=True, eq=False)
class Episode:
    """T steps and T+1 observations."""

    info: EpisodeInfo
    steps: tuple[Step, ...]
    final_observation: Observation
    final_state: NDArray[np.float64]
    terminated: bool
    """the task reached an end of its own (dm_env: discount 0)"""
    truncated: bool
    """the time ran out (dm_env: discount 1)"""
    outcome: Outcome
    metrics: Mapping[str, float] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.steps)


@dataclass(frozen=True, eq=False)
class Transition:
    """What an environment answers to an action."""

    observation: Observation
    reward: float
    terminated: bool
    truncated: bool
    commanded: Commanded | None = None
    """None where no command filter lies between the action and the physics"""


@dataclass(frozen=True, eq=False)
class SceneGeom:
    """One visible shape of the scene, fixed to a body, for viewers that know no simulator."""

    body: int
    """row in `ScenePose.bodies`"""
    shape: str
    """`box`, `sphere`, `capsule`, `cylinder`, `ellipsoid`, `mesh` or `picture` (textured plane)"""
    size: NDArray[np.float64]
    """(3,) metres: half extents of a box, ellipsoid or picture; (radius, half length, 0) of a
    capsule or cylinder along its z axis; (radius, 0, 0) of a sphere; scale of a mesh"""
    rgba: tuple[float, float, float, float]
    """each 0..1"""
    position_in_body: NDArray[np.float64]
    """(3,) metres"""
    wxyz_in_body: NDArray[np.float64]
    """(4,) unit quaternion"""
    vertices: NDArray[np.float32] | None = None
    """(v, 3) metres, of a mesh"""
    faces: NDArray[np.int32] | None = None
    """(t, 3), of a mesh"""
    picture: NDArray[np.uint8] | None = None
    """(h, w, 3) RGB, of a picture: row 0 lies at +y, column 0 at -x"""


@dataclass(frozen=True, eq=False)
class Surface:
    """A surface that deforms, as it is at one moment."""

    vertices_m: NDArray[np.float32]
    """(v, 3) in the world frame"""
    faces: NDArray[np.int32]
    """(t, 3); of a sheet that is cut they may differ from moment to moment"""
    rgb: tuple[float, float, float]
    """each 0..1"""


@dataclass(frozen=True, eq=False)
class Line:
    """A line that moves and grows, as it is at one moment."""

    points_m: NDArray[np.float32]
    """(k, 3) in the world frame; fewer than two are nothing"""
    rgb: tuple[float, float, float]
    """each 0..1"""


@dataclass(frozen=True, eq=False)
class ScenePose:
    """How a scene stands at one moment, in the world frame."""

    bodies: NDArray[np.float64]
    """(b, 7) position (m) and wxyz quaternion of every body"""
    tool_m: NDArray[np.float64] | None = None
    """(3,) the point whose path viewers draw: tool, car, player"""
    contacts_m: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 3)))
    """(c, 3) where bodies touch"""
    surfaces: tuple[Surface, ...] = ()
    """always as many"""
    lines: tuple[Line, ...] = ()
    """always as many: what is drawn on surfaces, such as a target and what is done of it"""
