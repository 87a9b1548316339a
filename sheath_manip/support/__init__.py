"""Support estimators by name, and the calibration of their threshold."""

import inspect
from collections.abc import Callable
from typing import Any

from sheath_manip.exceptions import UnknownNameError
from sheath_manip.plan import LearningPlan
from sheath_manip.protocols import SupportEstimator
from sheath_manip.support.agreeing_states import AgreeingSupport
from sheath_manip.support.disagreement import DisagreementSupport
from sheath_manip.support.distillation import DistillationSupport
from sheath_manip.support.kernel_density import KernelDensitySupport
from sheath_manip.support.loss_aware_svm import LossAwareSupport
from sheath_manip.support.mahalanobis import MahalanobisSupport
from sheath_manip.support.neighbors import NeighborSupport
from sheath_manip.support.one_class_svm import OneClassSupport
from sheath_manip.support.reconstruction import ReconstructionSupport

SUPPORTS: dict[str, Callable[..., SupportEstimator]] = {
    "one-class-svm": OneClassSupport,
    "loss-aware-svm": LossAwareSupport,
    "agreeing-svm": AgreeingSupport,
    "neighbors": NeighborSupport,
    "kernel-density": KernelDensitySupport,
    "mahalanobis": MahalanobisSupport,
    "reconstruction": ReconstructionSupport,
    "distillation": DistillationSupport,
    "disagreement": DisagreementSupport,
}
"""Called with hyperparameters by name."""

DEFAULT_SUPPORT = "one-class-svm"


def make_support(name: str = DEFAULT_SUPPORT, **hyperparameters: Any) -> SupportEstimator:
    """A fresh estimator of the table; UnknownNameError for a name that is not in it."""
    if name not in SUPPORTS:
        raise UnknownNameError("support estimator", name, SUPPORTS)
    return SUPPORTS[name](**hyperparameters)


def support_hyperparameters(plan: LearningPlan) -> dict[str, Any]:
    """What `plan` sets of its estimator; a bandwidth is for those that have one."""
    asked = {
        "nu": plan.nu,
        "bandwidth_factor": plan.bandwidth_factor,
        "bandwidth_unit": plan.bandwidth_unit,
    }
    taken = inspect.signature(type(make_support(plan.support))).parameters
    return {name: value for name, value in asked.items() if name in taken}
