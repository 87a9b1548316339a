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
    Judgement,
    Observation,
    Observations,
    Outcome,
    Proposal,
    Reason,
    SceneGeom,
    ScenePose,
    Step,
    TaskSpec,
    Transition,
)
from sheath_manip.types.samples import Samples
from sheath_manip.types.seen import Seen

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
class Follows(Protocol):
    """An expert that must know the way travelled, or a policy that looks at the physics."""

    def follow(self, observation: Observation) -> None:
        """Look at the state at each step, before anyone acts."""
        ...


class Policy(Protocol):
    """Proposes actions from what is observed: all that it takes to drive under a gate."""

    def reset(self, rng: np.random.Generator) -> None:
        """Begin an episode: forget the last one, and draw from `rng` from now on."""
        ...

    def propose(self, observations: Observations) -> Proposal:
        """Look once at the present observation (a batch of one), and propose.

        Called once a control step. What an embedding takes of the look goes along as latents, so
        that the gate judges this very proposal and no network sees an image twice.
        """
        ...


class TrainablePolicy(Policy, Protocol):
    """A policy that this framework can fit, save and load."""

    def fit(self, samples: Samples) -> Self:
        """Fit to the labels of `samples`, continuing from the present parameters, if any."""
        ...

    def predict(self, observations: Observations) -> Proposal:
        """Look at n states that have nothing to do with each other; nothing is drawn or kept.

        The latents hold what embeddings may take, so many states at once should be few: `look`
        goes through them in batches.
        """
        ...

    def surrogate_losses(self, proposal: Proposal, labels: NDArray) -> NDArray[np.float32]:
        """(n,) in 0..1: how far each predicted action is from its (n, a) label."""
        ...

    def arrays(self) -> Arrays:
        """The learned state."""
        ...

    def load(self, arrays: Arrays) -> Self:
        """Take over a learned state."""
        ...


@runtime_checkable
class HasOwnFrame(Protocol):
    """A policy that sees and acts in a frame of its own, in which alone actions compare."""

    def in_own_frame(self, actions: NDArray, features: NDArray) -> NDArray[np.float32]:
        """(n, a) `actions` of the task, in the frame that (n, f) `features` say."""
        ...


class Reader(Protocol):
    """Takes vectors of one kind from a look; equal readers read the same, and share the reading."""

    def __call__(self, observations: Observations, proposal: Proposal) -> NDArray[np.float32]:
        """(n, d) vectors; raises ParameterError where the proposal lacks the latents."""
        ...

    def __hash__(self) -> int:
        """Equal for equal readers: frozen dataclasses do."""
        ...


class Embedding(Protocol):
    """Makes of what was read the vectors on which the support is estimated, scaling included."""

    @property
    def uses_displaced(self) -> bool:
        """Whether `fit` needs `Seen.displaced`."""
        ...

    def attach(self, policy: TrainablePolicy) -> tuple[Reader, ...]:
        """Read looks of `policy` from now on; return all that is to be read of each.

        Raises ParameterError where it lacks what is needed.
        """
        ...

    def fit(self, seen: Seen) -> Self:
        """Fit to the training states, as the policy that it is attached to saw them."""
        ...

    def transform(self, seen: Seen) -> NDArray[np.float32]:
        """(n, d) scaled vectors of n states."""
        ...

    def arrays(self) -> Arrays:
        """The learned state, without the policy's."""
        ...

    def load(self, arrays: Arrays) -> Self:
        """Take over a learned state."""
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
    """Score how far the policy can be trusted in a state; higher is safer. Gates threshold it.

    What it measures in a state may be several numbers: `calibrate` learns how they lie among the
    expert's own steps, and `scores` makes one of them.
    """

    @property
    def uses_displaced(self) -> bool:
        """Whether `fit` needs `Seen.displaced`."""
        ...

    def attach(self, policy: TrainablePolicy) -> tuple[Reader, ...]:
        """Judge looks of `policy` from now on; return all that is to be read of each."""
        ...

    def fit(self, labels: NDArray, seen: Seen, agreement: Agreement | None = None) -> Self:
        """Fit to the training states, as the policy saw them, and their (n, a) labels."""
        ...

    def measure(self, seen: Seen) -> NDArray[np.float64]:
        """(n, p) what it says of n states, and of what the policy would do there.

        NaN where there is nothing to say; -inf is below any threshold.
        """
        ...

    def calibrate(self, measures: Sequence[NDArray]) -> Self:
        """Learn how the measures of held-out expert episodes lie, (n, p) of each episode."""
        ...

    def scores(self, measures: NDArray) -> NDArray[np.float64]:
        """(n,) the scores of (n, p) measures, the higher the better; NaN where there is none."""
        ...

    def blames(self, measures: NDArray) -> Reason:
        """Tell what is to blame for a low score of one state, (p,)."""
        ...

    def arrays(self) -> Arrays:
        """The learned state, without the policy's."""
        ...

    def load(self, arrays: Arrays) -> Self:
        """Take over a learned state."""
        ...


@runtime_checkable
class Refits(Protocol):
    """A signal with something that can be fitted again on policy and embedding as they are."""

    def refit(self, seen: Seen) -> Self:
        """Fit it to the training states; raises ParameterError where that cannot be done."""
        ...


class Judge(Protocol):
    """Says what it thinks of a proposal: a checkpoint does, by its signal."""

    def judge(self, observation: Observation, proposal: Proposal) -> Judgement:
        """Judge the proposal itself: nothing is asked of the policy again."""
        ...


class Gate(Protocol):
    """Decides at each step who acts and whether the expert is asked for a label."""

    def reset(self, rng: np.random.Generator) -> None:
        """Forget the last episode; all randomness comes from `rng`."""
        ...

    def decide(self, observation: Observation, proposal: Proposal | None) -> GateDecision:
        """Decide for one step; `proposal` is None where the policy had nothing valid to say."""
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
