"""Where a policy does as the expert would, judged by fits that have not seen the state.

On the states that it was fitted to a policy is right nearly everywhere (1.00 on driving), and the
states of one episode resemble each other: so whole episodes are held out, as in cross-validation.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from sheath_manip.counting import counted
from sheath_manip.exceptions import ParameterError
from sheath_manip.policies.looking import look
from sheath_manip.protocols import TrainablePolicy
from sheath_manip.types.samples import Samples


def held_out_agreement(
    make_policy: Callable[[], TrainablePolicy],
    samples: Samples,
    folds: int = 3,
    tolerance: float = 0.0,
) -> NDArray[np.bool_]:
    """(n,) whether a policy fitted to the other folds does as the label says.

    Costs `folds` fits from scratch. Episodes are dealt out in turn, so that each fold has some of
    every round; with fewer episodes than folds each is a fold of its own.

    Args:
        make_policy: a fresh policy, with no memory of `samples`.
        samples: of at least 2 episodes.
        folds: at least 2; more judge by policies closer to the one fitted to everything.
        tolerance: in 0..1, the surrogate loss up to which they agree: 0 where actions are choices;
            for continuous ones the expert's own noise, or a quantile of held-out losses.

    Raises:
        ParameterError: one episode only, or a parameter outside its range.
    """
    if folds < 2:
        raise ParameterError(f"folds is {folds}; wanted at least 2, like 3")
    if not 0 <= tolerance < 1:
        raise ParameterError(f"tolerance is {tolerance}; wanted a loss from 0 to below 1, like 0")
    episodes, rank = np.unique(samples.episodes, return_inverse=True)
    if len(episodes) < 2:
        raise ParameterError(
            f"{len(episodes)} episodes cannot be held out from each other; wanted at least 2"
        )
    fold = rank % min(folds, len(episodes))
    losses = np.empty(len(samples))
    numbers = np.unique(fold)
    for number in counted(numbers, len(numbers)):
        out = fold == number
        policy = make_policy().fit(samples.take(~out))
        losses[out] = look(policy, samples.take(out)).losses
    return losses <= tolerance
