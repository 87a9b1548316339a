"""Model-predictive search over short sequences of a few actions."""

from collections.abc import Callable, Sequence
from itertools import product

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError

CostOfSequences = Callable[[NDArray[np.float64]], NDArray[np.float64]]
"""(n, horizon, a) action sequences → (n,) costs from the present state"""


class SequenceSearch:
    """Tries every sequence of segments, each holding one of k actions, and ranks the first actions.

    With 3 actions and 5 segments these are the 243 sequences of the SHEATH draft's driving expert.
    """

    def __init__(self, choices: NDArray, segment_steps: Sequence[int]) -> None:
        if not segment_steps or min(segment_steps) < 1:
            raise ParameterError(
                f"segments of {segment_steps} steps; wanted at least one of 1 or more"
            )
        self._choices = np.asarray(choices, float)
        indices = np.array(list(product(range(len(self._choices)), repeat=len(segment_steps))))
        self.first = indices[:, 0]
        """(n,) which choice each sequence begins with"""
        self.sequences = self._choices[np.repeat(indices, segment_steps, axis=1)]
        """(n, horizon, a)"""

    def costs_of_first_actions(self, cost: CostOfSequences) -> NDArray[np.float64]:
        """(k,) for each choice, the cost of the best sequence that begins with it."""
        costs = cost(self.sequences)
        best = np.full(len(self._choices), np.inf)
        np.minimum.at(best, self.first, costs)
        return best

    def best_first_action(self, cost: CostOfSequences) -> NDArray[np.float32]:
        """(a,) the first action of the cheapest sequence."""
        return self._choices[int(np.argmin(self.costs_of_first_actions(cost)))].astype(np.float32)
