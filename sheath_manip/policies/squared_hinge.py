"""A linear support vector machine by Newton's method: exact, and quick where it is begun close.

Keerthi & DeCoste 2005, 'A modified finite Newton method for fast solution of large scale linear
SVMs': the objective ½|w|² + C Σ max(0, 1 - s_i w·x_i)² is quadratic for a given set of active
states (those within the margin), so each step solves for that set, and a few steps find it.

Measured with 8000 states of 550 binary features and four machines: 0.25 CPU seconds from the last
round's weights and 0.7 from none, where liblinear takes 0.7 to 1.2 to a looser tolerance.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve

from sheath_manip.exceptions import ParameterError

MOST_STEPS = 200
"""far more than it ever takes: about ten from nothing"""
TOLERANCE = 1e-6
"""largest change of a weight at the end, relative to the largest weight"""
HALVINGS = 30
"""of the interval in which a step's length is sought"""


def squared_hinge_weights(
    rows: NDArray[np.float64],
    signs: NDArray[np.float64],
    penalty: float,
    start: NDArray[np.float64] | None = None,
) -> NDArray[np.float64]:
    """(d,) the weights w that minimise ½|w|² + C Σ max(0, 1 - s_i w·x_i)².

    Args:
        rows: (n, d) features; a column of ones gives a bias, regularised as in liblinear.
        signs: (n,) each 1 or -1.
        penalty: C > 0.
        start: (d,) weights to begin from, such as those for fewer rows; they save time only.
    """
    width = rows.shape[1]
    weights = np.zeros(width) if start is None else start
    margins = signs * (rows @ weights)
    active = np.zeros(len(rows), dtype=bool)
    gram = np.zeros((width, width))
    for _ in range(MOST_STEPS):
        gram, active = _updated(gram, rows, active, margins < 1), margins < 1
        hessian = 2 * penalty * gram
        hessian.flat[:: width + 1] += 1
        pull = 2 * penalty * (signs[active] @ rows[active])
        solved = cho_solve(cho_factor(hessian, overwrite_a=True), pull)
        step = solved - weights
        if np.abs(step).max() <= TOLERANCE * max(np.abs(solved).max(), 1e-12):
            return solved
        change = signs * (rows @ step)
        length = _length(weights, step, margins, change, penalty)
        weights = weights + length * step
        margins = margins + length * change
    raise ParameterError(
        f"no convergence in {MOST_STEPS} steps for C = {penalty}; wanted features of about 1 and a "
        "smaller C"
    )


def _updated(
    gram: NDArray[np.float64],
    rows: NDArray[np.float64],
    before: NDArray[np.bool_],
    now: NDArray[np.bool_],
) -> NDArray[np.float64]:
    """Σ x xᵀ over the rows `now`, from that over the rows `before` where little has changed."""
    joining, leaving = now & ~before, before & ~now
    if joining.sum() + leaving.sum() >= now.sum():
        return rows[now].T @ rows[now]
    return gram + rows[joining].T @ rows[joining] - rows[leaving].T @ rows[leaving]


def _length(
    weights: NDArray[np.float64],
    step: NDArray[np.float64],
    margins: NDArray[np.float64],
    change: NDArray[np.float64],
    penalty: float,
) -> float:
    """Where along `step` the objective is least, in 0..1: where its slope crosses 0."""

    def slope(length: float) -> float:
        short = np.maximum(0, 1 - margins - length * change)
        return float((weights + length * step) @ step - 2 * penalty * (short @ change))

    if slope(1.0) <= 0:
        return 1.0
    low, high = 0.0, 1.0
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        low, high = (low, middle) if slope(middle) > 0 else (middle, high)
    return (low + high) / 2
