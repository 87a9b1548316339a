"""The quantities of the SHEATH draft's theorem 4.2, as they can be measured in one round."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sheath_manip.types import Episode


@dataclass(frozen=True)
class Bound:
    """J(pi) <= T (epsilon_N + xi): how many mistakes an episode holds, and what bounds them.

    The draft states it for the best policy in hindsight and the mass that the support estimate
    leaves out. The loss is 0-1 and 1 where the two controls DIFFER (the draft's Eq. 8 is inverted).
    """

    horizon: float
    """T: mean number of control steps of the round's episodes"""
    epsilon: float
    """epsilon_N: mean surrogate loss, over all aggregated states, of the policy fitted to them.
    It stands for the best policy in hindsight, to which the fit is an upper bound."""
    xi: float
    """share of ALL steps visited in the round that lie outside the support estimated before it"""
    measured: float
    """J: T times the mean surrogate loss, over the labelled states visited in the round, of the
    policy that drove it; NaN where there is none. Where labels were asked for in some states only,
    it says nothing about the others."""

    @property
    def value(self) -> float:
        """T (epsilon_N + xi): a visited state is outside, where the loss is at most 1, or inside.

        It bounds J only as far as the loss inside is epsilon's: on driving it is not, since the
        fitted policy errs three times as often on new states of the support as on those it was
        fitted to.
        """
        return self.horizon * (self.epsilon + self.xi)


def measure(
    episodes: Sequence[Episode],
    scores: np.ndarray,
    threshold: float,
    losses: np.ndarray,
    epsilon: float,
) -> Bound:
    """The bound of one round.

    `scores` are (n,) the support scores of all states of `episodes`, `losses` (m <= n,) the
    surrogate losses, over the labelled ones, of the policy that drove them. A score that is not a
    number counts as outside; without a threshold there is no support to be outside of, and xi is
    NaN.
    """
    horizon = float(np.mean([len(episode) for episode in episodes]))
    return Bound(
        horizon=horizon,
        epsilon=epsilon,
        xi=float(np.mean(~(scores >= threshold))) if np.isfinite(threshold) else float("nan"),
        measured=horizon * float(np.mean(losses)) if len(losses) else float("nan"),
    )
