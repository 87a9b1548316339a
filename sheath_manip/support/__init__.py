"""Support estimators by name, and the calibration of their threshold.

On a good embedding they differ little: AUROC of the policy's costly mistakes on driving, and
failures foreseen at a fifth of the failure-free windows disturbed (`sheath experiment gates`):

    one-class-svm     .908  94 %  the default: keeps few vectors, fits to 200,000 states
    kernel-density    .909  94 %  up to some thousand states, nothing to fit
    neighbors         .906  94 %  the same
    agreeing-svm      .908  94 %  where held-out policies mostly agree with the expert
    loss-aware-svm    .897  95 %  the same
    reconstruction    .903  94 %  a score costs the same however many states
    mahalanobis       .899  93 %  the same, and cheapest to score; suits unimodal data
    distillation      .887  88 %  kept to compare; wants many states
    disagreement      .887  89 %  kept to compare
"""

import inspect
from collections.abc import Callable
from typing import Any

from sheath_manip.protocols import SupportEstimator
from sheath_manip.registry import Registry
from sheath_manip.support.config import SupportConfig

_HERE = "sheath_manip.support"

SUPPORTS: Registry[Callable[..., SupportEstimator]] = Registry(
    "support estimator",
    "sheath.supports",
    {
        "one-class-svm": f"{_HERE}.one_class_svm:OneClassSupport",
        "loss-aware-svm": f"{_HERE}.loss_aware_svm:LossAwareSupport",
        "agreeing-svm": f"{_HERE}.agreeing_states:AgreeingSupport",
        "neighbors": f"{_HERE}.neighbors:NeighborSupport",
        "kernel-density": f"{_HERE}.kernel_density:KernelDensitySupport",
        "mahalanobis": f"{_HERE}.mahalanobis:MahalanobisSupport",
        "reconstruction": f"{_HERE}.reconstruction:ReconstructionSupport",
        "distillation": f"{_HERE}.distillation:DistillationSupport",
        "disagreement": f"{_HERE}.disagreement:DisagreementSupport",
    },
)
"""Called with hyperparameters by name."""

DEFAULT_SUPPORT = "one-class-svm"


def make_support(name: str = DEFAULT_SUPPORT, **hyperparameters: Any) -> SupportEstimator:
    """A fresh estimator of the table; UnknownNameError for a name that is not in it."""
    return SUPPORTS[name](**hyperparameters)


def support_hyperparameters(config: SupportConfig) -> dict[str, Any]:
    """Return what `config` sets of its estimator; a bandwidth is for those that have one."""
    asked = {
        "nu": config.nu,
        "bandwidth_factor": config.bandwidth_factor,
        "bandwidth_unit": config.bandwidth_unit,
    }
    taken = inspect.signature(type(make_support(config.name))).parameters
    return {name: value for name, value in asked.items() if name in taken}
