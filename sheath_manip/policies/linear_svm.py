"""Linear support vector machines on the observation's features, one a button.

Ross, Gordon & Bagnell 2011, 'A reduction of imitation learning and structured prediction to
no-regret online learning', section 5.2 (Super Mario Bros.). Each problem is convex: a fit ends at
the same machines wherever it begins.
"""

from typing import Self

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError
from sheath_manip.policies.choices import (
    choices_of,
    likeliest,
    nearest_choices,
    zero_one_losses,
)
from sheath_manip.policies.learned_arrays import numbers
from sheath_manip.policies.memoryless import Memoryless
from sheath_manip.policies.requirements import require_features
from sheath_manip.policies.squared_hinge import squared_hinge_weights
from sheath_manip.protocols import Arrays
from sheath_manip.types import Observations, Proposal, TaskSpec
from sheath_manip.types.samples import Samples

PENALTIES = (0.01, 0.03, 0.1, 0.3, 1.0)
"""C's that cross-validation chooses from"""
MOST_FOLDS = 3
PENALTY_UNTRIED = 0.1
"""C for states of a single episode, of which none can be held out"""


class LinearSvm(Memoryless):
    """Presses those buttons whose machines speak for it, as far as they are an admissible action.

    A button is a dimension of the action that is at its minimum or maximum. Of the admissible
    actions the one is taken for which the buttons' scores, signed, sum to most: what the machines
    say one by one where that is admissible, and else without the least certain of them.
    """

    def __init__(self, spec: TaskSpec, penalty: float | None = None, seed: int = 0) -> None:
        """Store the hyperparameters.

        Args:
            spec: of the task; its choices must be combinations of buttons.
            penalty: C of the machines. None: the one of `PENALTIES` that errs least on held-out
                episodes, chosen in the first fit and kept from then on.
            seed: unused, since nothing is drawn; policies are all made alike.
        """
        self.spec = spec
        self.penalty = penalty
        self.seed = seed
        self.choices = choices_of(spec)
        low, high = spec.action.minimum, spec.action.maximum
        if not ((self.choices == low) | (self.choices == high)).all():
            raise ParameterError(
                f"task {spec.name!r} has actions between minimum and maximum; wanted buttons, "
                "each at one of them in every choice"
            )
        require_features(spec)
        self._signs = np.where(self.choices == high, 1, -1).astype(np.float32)

    def fit(self, samples: Samples) -> Self:
        """Fit to (n, a) labels, each taken as its nearest choice; ParameterError for none."""
        if len(samples) == 0:
            raise ParameterError("no samples to fit to; wanted at least one labelled state")
        rows = _with_ones(samples.features)
        signs = self._signs[nearest_choices(self.choices, samples.labels)].astype(np.float64)
        if not hasattr(self, "penalty_"):
            self.penalty_ = self._best_penalty(rows, signs, samples.episodes)
        start = self.machines_ if hasattr(self, "machines_") else None
        return self._take(_machines(rows, signs, self.penalty_, start))

    def predict(self, observations: Observations) -> Proposal:
        """Take admissible actions by the features; images go unused.

        Latents: the sums of the buttons' scores, signed, as (n, k) `choice scores`.
        """
        weights, biases = self._fitted()
        scores = (observations.features @ weights.T + biases) @ self._signs.T
        return Proposal(likeliest(self.choices, scores), {"choice scores": scores})

    def surrogate_losses(self, proposal: Proposal, labels: NDArray) -> NDArray[np.float32]:
        """(n,) 1 where any button differs from its label, else 0 (Eq. 8, righted)."""
        return zero_one_losses(self.choices, proposal.now, labels)

    def feature_weights(self) -> NDArray[np.float32]:
        """(f,) the norm of a feature's weights over all machines."""
        weights, _ = self._fitted()
        return np.linalg.norm(weights, axis=0)

    def arrays(self) -> Arrays:
        """Machines (a, f + 1), the last column their biases, and their C."""
        self._fitted()
        return {"machines": self.machines_, "penalty": np.array(self.penalty_)}

    def load(self, arrays: Arrays) -> Self:
        """Take over `arrays()`; ParameterError for another number of buttons or features."""
        # One for each button, with a weight for each feature and a bias.
        shape = len(self.spec.action.names), len(self.spec.feature_names) + 1
        machines = numbers(arrays, "machines", *shape)
        self.penalty_ = float(numbers(arrays, "penalty"))
        return self._take(machines.astype(np.float64))

    def _take(self, machines: NDArray[np.float64]) -> Self:
        self.machines_ = machines
        self._weights = np.ascontiguousarray(machines[:, :-1], dtype=np.float32)
        self._biases = machines[:, -1].astype(np.float32)
        return self

    def _fitted(self) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        if not hasattr(self, "machines_"):
            raise ParameterError("the policy is not fitted yet; call fit or load first")
        return self._weights, self._biases

    def _best_penalty(
        self, rows: NDArray[np.float64], signs: NDArray[np.float64], episodes: NDArray[np.int64]
    ) -> float:
        """The C that errs least on held-out episodes, of equal ones the smallest."""
        if self.penalty is not None:
            return self.penalty
        numbers, rank = np.unique(episodes, return_inverse=True)
        if len(numbers) < 2:
            return PENALTY_UNTRIED
        fold = rank % min(MOST_FOLDS, len(numbers))
        errors = np.zeros(len(PENALTIES))
        for number in np.unique(fold):
            out, machines = fold == number, None
            for index, penalty in enumerate(PENALTIES):
                machines = _machines(rows[~out], signs[~out], penalty, machines)
                chosen = ((rows[out] @ machines.T) @ self._signs.T).argmax(axis=1)
                errors[index] += (self._signs[chosen] != signs[out]).any(axis=1).sum()
        return PENALTIES[int(errors.argmin())]


def _machines(
    rows: NDArray[np.float64],
    signs: NDArray[np.float64],
    penalty: float,
    start: NDArray[np.float64] | None,
) -> NDArray[np.float64]:
    """(a, f + 1) one machine for each column of (n, a) `signs`."""
    machines = np.zeros((signs.shape[1], rows.shape[1]))
    for number, wanted in enumerate(signs.T):
        if (wanted == wanted[0]).all():
            # Never pressed, or never released: what else the states show says nothing about it.
            machines[number, -1] = wanted[0]
            continue
        first = None if start is None else start[number]
        machines[number] = squared_hinge_weights(rows, wanted, penalty, first)
    return machines


def _with_ones(features: NDArray) -> NDArray[np.float64]:
    """(n, f + 1) float64, the last column 1."""
    return np.column_stack([features, np.ones(len(features))]).astype(np.float64)
