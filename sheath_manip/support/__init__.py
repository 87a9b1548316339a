"""Support estimators by name, and the calibration of their threshold.

On a good embedding they differ little: AUROC of the policy's costly mistakes on driving, and
failures foreseen at a fifth of the failure-free windows disturbed (`sheath experiment gates`):

    one-class-svm     .908  94 %  the default: keeps few vectors, fits to 200,000 states
    kernel-density    .909  94 %  up to some thousand states, nothing to fit
    neighbors         .906  94 %  likewise
    agreeing-svm      .908  94 %  where held-out policies mostly agree with the expert
    loss-aware-svm    .897  95 %  likewise
    reconstruction    .903  94 %  a score costs the same however many states
    mahalanobis       .899  93 %  likewise and cheapest, where the states are one cloud
    distillation      .887  88 %  kept to compare; wants many states
    disagreement      .887  89 %  kept to compare
"""

import inspect
from collections.abc import Callable
from typing import Any

from sheath_manip.exceptions import UnknownNameError
from sheath_manip.learning.config import LearningPlan
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
