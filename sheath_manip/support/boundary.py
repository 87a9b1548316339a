"""Where a support ends: score 0, with at most a share nu of the training points beyond it."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError


def check_share(name: str, value: float) -> None:
    """ParameterError where `value` is no share of the training points."""
    if not 0 < value <= 1:
        raise ParameterError(f"{name} is {value}; wanted a share above 0 and at most 1, like 0.05")


def check_positive(**parameters: float) -> None:
    """ParameterError for the first that is not a positive finite number."""
    for name, value in parameters.items():
        if not 0 < value < np.inf:
            raise ParameterError(f"{name} is {value}; wanted a positive number, like 1.0")


def check_least(least: Mapping[str, tuple[int, int]]) -> None:
    """ParameterError for the first (value, least value) by name that falls short."""
    for name, (value, bound) in least.items():
        if value < bound:
            raise ParameterError(f"{name} is {value}; wanted at least {bound}")


def nu_boundary(scores: NDArray[np.float64], nu: float) -> float:
    """The nu-quantile of the training points' (n,) raw scores, for methods with no nu of their own.

    It lies a little lower than that by rounding: a point's score depends on its last bit on the
    points that are scored along with it, and repeated points all lie on the boundary.
    """
    boundary = float(np.quantile(scores, nu, method="lower"))
    return boundary - 1e-6 * max(1.0, float(np.ptp(scores)))


def svm_boundary(rho: float, nu: float) -> float:
    """A one-class SVM's offset, with duals that sum to 1, less a margin for rounding.

    Support vectors on the boundary sit at 0 ± rounding, and with a small c most points are such:
    without a margin 30-60 % of the training set would be rejected. A hundredth of rho bounds it, so
    that it never lets in what is unlike every point and scores -rho.
    """
    return rho - min(max(1e-4 * nu, 1e-6), 1e-2 * rho)
