"""Support estimators by name, and the calibration of their threshold."""

from collections.abc import Callable
from typing import Any

from sheath_manip.exceptions import UnknownNameError
from sheath_manip.protocols import SupportEstimator
from sheath_manip.support.one_class_svm import OneClassSupport

SUPPORTS: dict[str, Callable[..., SupportEstimator]] = {
    "one-class-svm": OneClassSupport,
}
"""Called with hyperparameters by name."""

DEFAULT_SUPPORT = "one-class-svm"


def make_support(name: str = DEFAULT_SUPPORT, **hyperparameters: Any) -> SupportEstimator:
    """A fresh estimator of the table; UnknownNameError for a name that is not in it."""
    if name not in SUPPORTS:
        raise UnknownNameError("support estimator", name, SUPPORTS)
    return SUPPORTS[name](**hyperparameters)
