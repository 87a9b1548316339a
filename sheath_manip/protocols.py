"""The few interfaces: what a task, expert, policy, support, gate and listener must offer."""

from collections.abc import Callable, Mapping, Sequence
from typing import ClassVar, Protocol, Self, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from sheath_manip.types import (
    Action,
    Episode,
    EpisodeInfo,
    GateDecision,
    Observation,
    Outcome,
    SceneGeom,
    ScenePose,
    Step,
    TaskSpec,
    Transition,
)
from sheath_manip.types.samples import Samples

Arrays = Mapping[str, NDArray]
"""The learned state of a component as plain arrays: what a checkpoint holds, with no code in it."""

Report = Callable[[str], None]
"""called once for each unit of work done, with a word on what it was"""

Agreement = Callable[[], NDArray[np.bool_]]
"""(n,) whether the policy does as the expert would in its n training states, judged by fits that
have not seen them (`policies.agreement`); it takes long, so it is called only where needed"""


class Environment(Protocol):
    """A seeded task: the same seed and actions give the same episode to the bit."""

    @property
    def spec(self) -> TaskSpec:
        """The task's constant description."""
        ...

    def reset(self, seed: int) -> Observation:
        """Start the episode that belongs to `seed`."""
        ...

    def step(self, action: Action) -> Transition:
        """Run one control step."""
        ...

    def outcome(self) -> Outcome:
        """How the episode stands: TIME_LIMIT until it succeeds or fails."""
        ...

    def metrics(self) -> Mapping[str, float]:
        """The episode's figures so far, `spec.metric` among them."""
        ...

    def state(self) -> NDArray[np.float64]:
        """(s,) the whole simulator state."""
        ...

    def restore(self, state: NDArray[np.float64]) -> Observation:
        """Continue from a `state()` of an episode with the present seed."""
        ...

    def scene(self) -> Sequence[SceneGeom]:
        """The visible shapes, constant between resets."""
        ...

    def pose(self) -> ScenePose:
        """How the scene stands now."""
        ...

    def pose_at(self, state: NDArray[np.float64]) -> ScenePose:
        """How it stood in `state`, at which the episode then stands; nothing is observed."""
        ...

    def close(self) -> None:
        """Free what the simulator and its renderer hold."""
        ...


class Expert(Protocol):
    """Knows what to do from any state; may look at the physics, given in its constructor."""

    def reset(self) -> None:
        """Forget the last episode; called after the environment's reset."""
        ...

    def act(self, observation: Observation) -> Action:
        """(a,) what the expert would do now. Asked at most once a step."""
        ...


@runtime_checkable
class TakesOver(Expert, Protocol):
    """An expert that keeps a pose of its own, such as a person's device, and must not jump."""

    def take_over(self, observation: Observation) -> None:
        """Start from the present state: called at each change to the expert, before it is asked."""
        ...


@runtime_checkable
class Follows(Expert, Protocol):
    """An expert that must know the way that was travelled, also while the policy acts."""

    def follow(self, observation: Observation) -> None:
        """Look at the state at each step, before anyone acts."""
        ...


class Proposer(Protocol):
    """Says at each step what it would do: all that the loop wants of a policy."""

    def act(self, observation: Observation) -> Action:
        """(a,) the action for one observation."""
        ...


class Policy(Proposer, Protocol):
    """Maps observations to actions; looks at the observation only."""

    def fit(self, samples: Samples) -> Self:
        """Fit to the labels of `samples`, continuing from the present parameters, if any."""
        ...

    def predict(
        self, images: Mapping[str, NDArray[np.uint8]], features: NDArray
    ) -> NDArray[np.float32]:
        """(n, a) actions for (n, h, w, 3) images by camera and (n, f) features."""
        ...

    def surrogate_losses(self, samples: Samples) -> NDArray[np.float32]:
        """(n,) in 0..1: how far each predicted action is from its label."""
        ...

    def arrays(self) -> Arrays:
        """The learned state."""
        ...

    def load(self, arrays: Arrays) -> Self:
        """Take over a learned state."""
        ...


@runtime_checkable
class ScoresChoices(Policy, Protocol):
    """A policy of tasks with choices that says how it ranks them."""

    def choice_scores(
        self, images: Mapping[str, NDArray[np.uint8]], features: NDArray
    ) -> NDArray[np.floating]:
        """(n, k) one for each choice of the task; it takes the one with the highest."""
        ...


@runtime_checkable
class HasOwnFrame(Policy, Protocol):
    """A policy that sees and acts in a frame of its own, in which alone actions compare."""

    def in_own_frame(self, actions: NDArray, features: NDArray) -> NDArray[np.float32]:
        """(n, a) `actions` of the task, in the frame that (n, f) `features` say."""
        ...


class Embedding(Protocol):
    """Maps observations to the vectors on which the support is estimated, scaling included."""

    def fit(self, policy: Policy, samples: Samples) -> Self:
        """Fit to the training states of `policy`."""
        ...

    def transform(
        self, images: Mapping[str, NDArray[np.uint8]], features: NDArray
    ) -> NDArray[np.float32]:
        """(n, d) scaled vectors for (n, h, w, 3) images by camera and (n, f) features."""
        ...

    def arrays(self) -> Arrays:
        """The learned state, without the policy's."""
        ...

    def load(self, policy: Policy, arrays: Arrays) -> Self:
        """Take over a learned state on top of `policy`."""
        ...


class SupportEstimator(Protocol):
    """Says how far inside the training data's support a vector lies."""

    uses_agreement: ClassVar[bool]
    """whether `fit` looks at `agrees`, which is expensive to come by"""

    def fit(self, X: NDArray, agrees: NDArray | None = None) -> Self:
        """Fit to (n, d) vectors.

        `agrees` is (n,) bool: whether the policy does there as the expert would, judged by a fit
        that has not seen the state (`policies.agreement`). None: it does everywhere.
        """
        ...

    def decision_function(self, X: NDArray) -> NDArray[np.float64]:
        """(n,) scores, positive inside; a row that is not finite scores NaN.

        -inf is outside whatever the threshold.
        """
        ...

    def arrays(self) -> Arrays:
        """The learned state."""
        ...

    def load(self, arrays: Arrays) -> Self:
        """Take over a learned state."""
        ...


class Signal(Protocol):
    """Says of a state how far the policy may be trusted with it: what a gate looks at."""

    def fit(self, policy: Policy, states: Samples, agreement: Agreement | None = None) -> Self:
        """Fit to the training `states` of `policy`, and look through that policy from now on."""
        ...

    def calibrate(self, episodes: Sequence[Samples]) -> Self:
        """Learn what held-out expert episodes, that no fit has seen, look like."""
        ...

    def scores(
        self, images: Mapping[str, NDArray[np.uint8]], features: NDArray
    ) -> NDArray[np.float64]:
        """(n,) the higher the better, for (n, h, w, 3) images by camera and (n, f) features.

        NaN where there is none; -inf is below any threshold.
        """
        ...

    def arrays(self) -> Arrays:
        """The learned state, without the policy's."""
        ...

    def load(self, policy: Policy, arrays: Arrays) -> Self:
        """Take over a learned state on top of `policy`."""
        ...


@runtime_checkable
class Refits(Protocol):
    """A signal with something that can be fitted again on policy and embedding as they are."""

    def refit(self, states: Samples) -> Self:
        """Fit it to the training `states`; raises ParameterError where that cannot be done."""
        ...


class Gate(Protocol):
    """Decides at each step who acts and whether the expert is asked for a label."""

    def reset(self, rng: np.random.Generator) -> None:
        """Forget the last episode; all randomness comes from `rng`."""
        ...

    def decide(self, observation: Observation, proposed: Action | None) -> GateDecision:
        """Decide for one step; `proposed` is None where the policy had nothing valid to say."""
        ...


class Listener(Protocol):
    """Follows a run without the loop knowing what it is: recorder, dashboard, progress bar."""

    def on_fit(self, states: Samples) -> None:
        """Called once policy and support have been fitted to `states`."""
        ...

    def on_start(self, environment: Environment, info: EpisodeInfo) -> None:
        """Called after the environment's reset."""
        ...

    def on_step(self, environment: Environment, step: Step) -> None:
        """Called after each step; may block, for instance while a person holds the run paused."""
        ...

    def on_end(self, episode: Episode) -> None:
        """Called once the episode is complete."""
        ...
