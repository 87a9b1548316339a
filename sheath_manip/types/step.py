"""One control step: what is seen, who acts and why, what became of it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sheath_manip.types.spec import Action


class Actor(StrEnum):
    """Who drives a control step; a gate's decision names one, and the loop asks that one."""

    POLICY = "policy"
    """what was learned"""
    EXPERT = "expert"
    """who knows what to do, and labels: the task's script, or what stands in its place"""
    OPERATOR = "operator"
    """a person at the controls"""
    FALLBACK = "fallback"
    """the controller that acts where a person was asked and did not come"""
    HOLD = "hold"
    """nobody: the robot is kept where it is"""

    @property
    def in_place_of_policy(self) -> bool:
        """Whether somebody drives who is not the policy; to hold is no driving."""
        return self in (Actor.EXPERT, Actor.OPERATOR, Actor.FALLBACK)


class Reason(StrEnum):
    """Why a gate chose its actor."""

    FIXED = "fixed"
    """the gate always says so, or its schedule does"""
    DRAWN = "drawn"
    """a random draw decided"""
    INSIDE = "inside support"
    """the score is not below the threshold: the policy acts"""
    OUTSIDE = "outside support"
    """the score is below the threshold, since the state is unlike the training states"""
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
    """the wait for a person is over: the fallback controller acts"""
    EMERGENCY_STOP = "emergency stop"
    """somebody stopped the robot, and nobody has reset it yet"""
    POLICY_FAILED = "policy failed"
    """the policy broke down in place of a proposal: as an invalid one"""
    GATE_FAILED = "gate failed"
    """the gate broke down in place of a decision: the expert acts"""
    ACTOR_FAILED = "actor failed"
    """whose turn it was broke down: the fallback controller acts, or the robot holds"""
    ENVIRONMENT_FAILED = "environment failed"
    """the environment broke down: the robot holds, and the run ends"""
    TOO_LATE = "too late"
    """the policy's proposal, or the gate's leave, came after the deadline: the expert acts"""
    STUCK = "no progress"
    """the states are familiar, but nothing has moved for a while: the expert shows the way on"""
    SPARED = "request spared"
    """the next alarm would be one request too many, or this one is: the expert drives on, and where
    nobody is there the fallback controller acts"""


@dataclass(frozen=True, eq=False)
class Observation:
    """An observation: what is seen at one control step."""

    images: Mapping[str, NDArray[np.uint8]]
    """(h, w, 3) RGB by camera"""
    features: NDArray[np.float32]
    """(f,) in the order of `TaskSpec.feature_names`"""
    time_s: float
    instruction: str = ""
    """what the robot is told to do, where the task says it in words; one for a whole episode"""

    @property
    def alone(self) -> "Observations":
        """The observation as a batch of one."""
        images = {camera: image[None] for camera, image in self.images.items()}
        told = (self.instruction,) if self.instruction else None
        return Observations(images, self.features[None], told)


@dataclass(frozen=True, eq=False)
class Observations:
    """n observations side by side, as policies look at them."""

    images: Mapping[str, NDArray[np.uint8]]
    """(n, h, w, 3) RGB by camera"""
    features: NDArray[np.float32]
    """(n, f)"""
    instructions: tuple[str, ...] | None = None
    """n texts, what the robot is told to do in each; None where the task has none"""

    def __len__(self) -> int:
        return len(self.features)

    def rows(self, rows: slice) -> "Observations":
        """Return some of them."""
        images = {camera: images[rows] for camera, images in self.images.items()}
        told = None if self.instructions is None else self.instructions[rows]
        return Observations(images, self.features[rows], told)


@dataclass(frozen=True, eq=False)
class Proposal:
    """A proposal: what a policy made of n observations in one look."""

    actions: NDArray[np.float32]
    """(n, a), or (n, k, a) for chunks of the next k actions"""
    latents: Mapping[str, Any] = field(default_factory=dict)
    """arrays or tensors by name, for embeddings to take: what the policy saw on its way"""

    @property
    def now(self) -> NDArray[np.float32]:
        """(n, a) the action for the present step of each."""
        return self.actions if self.actions.ndim == 2 else self.actions[:, 0]


@dataclass(frozen=True, order=True)
class SignalScore:
    """One signal's score of a step, and how it lies among those of the expert's own steps."""

    signal: str
    """such as `support`; a step names each at most once"""
    score: float
    """the higher the safer; no NaN: a signal that has nothing to say is not named"""
    share: float
    """0..1 of held-out expert steps that score lower; NaN where no such steps are known"""


@dataclass(frozen=True)
class Judgement:
    """A judgement: what a signal says of a state and of what the policy proposes there."""

    score: float
    """the higher the safer, to be held against a threshold; NaN where there is none"""
    blames: Reason = Reason.OUTSIDE
    """why the expert takes over where the score is below the threshold"""
    signals: tuple[SignalScore, ...] = ()
    """what the score is made of, sorted by name"""


@dataclass(frozen=True, order=True)
class Breakdown:
    """A breakdown: a call that failed, said rubbish, or took too long."""

    who: str
    """`policy`, `gate`, `environment`, or the actor that was asked"""
    what: str
    """the class of the error, such as `ValueError`; or `late` or `hung`"""


@dataclass(frozen=True)
class GateDecision:
    """Who acts, and whether the expert is asked for a label: two separate outputs of a gate."""

    actor: Actor
    query: bool
    """ask the expert for a label even though the policy may act"""
    reason: Reason
    score: float = float("nan")
    """the signal's, the higher the safer: of the support alone positive inside; of joined signals a
    sum of logarithms, below 0; the threshold decides. NaN where the gate computes none"""
    threshold: float = float("nan")
    """the score below which the expert takes over; NaN where the gate has none"""
    broken: tuple[Breakdown, ...] = ()
    """what broke down in this step, in that order"""
    waited_s: float = 0.0
    """for a person, before this step: the simulation stood still meanwhile, so it is no step"""
    signals: tuple[SignalScore, ...] = ()
    """what the score is made of, sorted by name; empty where the gate computes none"""


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

        Holding the robot in the expert's place counts as acting but gives no label.
        """
        return self.labelled if self.decision.query else None

    @property
    def requested(self) -> Action:
        """What the actor asked for: given to the environment, it runs the step again to the bit."""
        asked = self.proposed if self.decision.actor is Actor.POLICY else self.labelled
        return self.executed if asked is None else asked


@dataclass(frozen=True, eq=False)
class Transition:
    """A transition: what an environment answers to an action."""

    observation: Observation
    reward: float
    terminated: bool
    truncated: bool
    commanded: Commanded | None = None
    """None where no command filter lies between the action and the physics"""
