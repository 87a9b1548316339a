"""Actions as classes: the admissible actions of a discrete task, and the loss between them."""

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError
from sheath_manip.policies.requirements import OWN_POLICY
from sheath_manip.types import TaskSpec


def choices_of(spec: TaskSpec) -> NDArray[np.float32]:
    """(k, a) the task's admissible actions; ParameterError where its action space is continuous."""
    if spec.action.choices is None or len(spec.action.choices) < 2:
        raise ParameterError(
            f"task {spec.name!r} has no list of admissible actions; "
            "a classifier needs an ActionSpec with at least two choices. Where actions are "
            f"continuous, spatial-cnn does with a camera and mlp with features, {OWN_POLICY}"
        )
    return np.asarray(spec.action.choices, dtype=np.float32)


def nearest_choices(choices: NDArray, actions: NDArray) -> NDArray[np.int64]:
    """(n,) the row of `choices` (k, a) nearest to each of (n, a) `actions`."""
    distances = np.abs(np.asarray(actions)[:, None, :] - choices[None]).sum(axis=2)
    return distances.argmin(axis=1).astype(np.int64)


def likeliest(choices: NDArray, scores: NDArray) -> NDArray[np.float32]:
    """(n, a) the choice with the highest of (n, k) `scores`; NaN, no action, where one is NaN.

    NumPy takes the first NaN for the highest, so that a network which says nothing would drive.
    The highest must be finite; -inf says of a choice that it is out of the question.
    """
    chosen = choices[scores.argmax(axis=1)]
    silent = ~np.isfinite(scores.max(axis=1))
    return np.where(silent[:, None], np.float32(np.nan), chosen) if silent.any() else chosen


def zero_one_losses(choices: NDArray, predicted: NDArray, labels: NDArray) -> NDArray[np.float32]:
    """(n,) 1 where the predicted action is another choice than the label's, else 0.

    The paper's Eq. 8 reads the other way round (1 where the controls are equal), which is a slip:
    the text and the bound built on it need a loss that is 0 on agreement.
    """
    wrong = nearest_choices(choices, predicted) != nearest_choices(choices, labels)
    return wrong.astype(np.float32)
