"""What must be offered to be fitted, saved and loaded: policies, embeddings, supports, signals."""

from collections.abc import Callable, Mapping, Sequence
from typing import ClassVar, Protocol, Self, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from sheath_manip.protocols.acting import Policy
from sheath_manip.types import Observations, Proposal, Reason, SignalScore
from sheath_manip.types.samples import Samples
from sheath_manip.types.seen import Precedents, Seen

Arrays = Mapping[str, NDArray]
"""The learned state of a component as plain arrays: what a checkpoint holds, with no code in it."""


Agreement = Callable[[], NDArray[np.bool_]]
"""(n,) whether the policy does as the expert would in its n training states, judged by fits that
have not seen them (`policies.agreement`); it takes long, so it is called only where needed"""


class PredictingPolicy(Policy, Protocol):
    """A policy that a gate can be fitted around: it looks at many recorded states at once."""

    def predict(self, observations: Observations) -> Proposal:
        """Look at n states that have nothing to do with each other; nothing is drawn or kept.

        The latents hold what embeddings may take, so many states at once should be few: `look`
        goes through them in batches.
        """
        ...

    def surrogate_losses(self, proposal: Proposal, labels: NDArray) -> NDArray[np.float32]:
        """Return (n,) losses in 0..1: how far each predicted action is from its (n, a) label."""
        ...


class TrainablePolicy(PredictingPolicy, Protocol):
    """A policy that this framework can fit, save and load."""

    def fit(self, samples: Samples) -> Self:
        """Fit to the labels of `samples`, continuing from the present parameters, if any."""
        ...

    def arrays(self) -> Arrays:
        """The learned state."""
        ...

    def load(self, arrays: Arrays) -> Self:
        """Take over a learned state."""
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

    def attach(self, policy: PredictingPolicy) -> tuple[Reader, ...]:
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

    def attach(self, policy: PredictingPolicy) -> tuple[Reader, ...]:
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
class HasFloor(Protocol):
    """A support or a signal, fitted, whose scores do not fall without bound far away."""

    @property
    def far_score(self) -> float:
        """The score infinitely far from all training states, below 0."""
        ...


@runtime_checkable
class HasParts(Protocol):
    """A signal, calibrated, that is made of several."""

    def signal_scores(self, measures: NDArray) -> tuple[SignalScore, ...]:
        """Return what each scores in one state, (p,), sorted by name; without NaNs."""
        ...


@runtime_checkable
class HasPrecedents(Protocol):
    """A signal, fitted, that compares a state with the single states that it was fitted to."""

    def nearest_states(self, seen: Seen, count: int) -> Precedents | None:
        """Return the training states nearest to one state, whatever was done there.

        None where nothing can be compared, such as for a state that is not finite.
        """
        ...


@runtime_checkable
class Refits(Protocol):
    """A signal with something that can be fitted again on policy and embedding as they are."""

    def refit(self, seen: Seen) -> Self:
        """Fit it to the training states; raises ParameterError where that cannot be done."""
        ...
