"""One dual small enough that libsvm holds its whole matrix."""

import numpy as np
from numpy.typing import NDArray
from sklearn.svm import OneClassSVM


def solve_dense(
    gram: NDArray[np.float64], most: NDArray[np.float64], total: float, tolerance: float
) -> tuple[NDArray[np.float64], float]:
    """(n,) duals α that minimise ½ αᵀ gram α, and the score on the boundary.

    Args:
        gram: (n, n), of which libsvm keeps float32.
        most: (n,) bounds: 0 <= α_i <= most_i.
        total: what the duals sum to; at most the sum of `most`.
        tolerance: on the scores, were the largest bound 1.
    """
    # libsvm bounds a dual by its sample's weight and makes them sum to nu · Σ weights.
    machine = OneClassSVM(
        kernel="precomputed", nu=min(total / most.sum(), 1.0), tol=max(tolerance, 1e-12)
    )
    machine.fit(gram, sample_weight=most / most.max())
    weights = np.zeros(len(most))
    weights[machine.support_] = np.asarray(machine.dual_coef_)[0]
    scale = total / weights.sum()
    return weights * scale, float(np.ravel(machine.offset_)[0]) * scale
