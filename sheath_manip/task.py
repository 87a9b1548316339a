"""What a task offers to the framework: one entry of the written-out table TASKS."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sheath_manip.cockpit.expert import Hands
from sheath_manip.exceptions import UnknownNameError
from sheath_manip.experiments.claims import Claim
from sheath_manip.experiments.probes import Probes
from sheath_manip.learning.config import LearningPlan
from sheath_manip.protocols import Environment, Expert

SCRIPTED = "scripted"
"""the name of a task's own expert beside its stand-ins"""


@dataclass(frozen=True)
class Task:
    """How to make a task, its expert and its experiment. Everything in it can be pickled."""

    name: str
    summary: str
    variants: Mapping[str, Callable[[], Environment]]
    """by name; `default` is used where none is asked for, `final` to judge final policies"""
    expert: Callable[[Any], Expert]
    """from the environment, since an expert may look at the physics"""
    plans: Mapping[str, LearningPlan]
    """`full` and `quick`"""
    stand_ins: Mapping[str, Callable[[Any], Expert]] = field(default_factory=dict)
    """by name, from the environment: who acts in the expert's place where there is none, such as
    `hold`"""
    references: Mapping[str, Callable[[Any], Expert]] = field(default_factory=dict)
    """by name, from the environment: who learns nothing, to hold the experiment's methods against
    on the final scenes"""
    hands: Callable[[Any], Hands] | None = None
    """from the environment: how a person's devices drive it; None where nobody can"""
    run_variants: Mapping[str, Callable[[int], Environment]] = field(default_factory=dict)
    """by name, from the seed of a training run: all its episodes belong to one scene of the run's
    own, such as one stage, and their seeds choose what else may differ"""
    figures: Mapping[str, Callable[..., None]] = field(default_factory=dict)
    """figures of this task alone, by name"""
    picture: Callable[[Any], NDArray[np.uint8]] | None = None
    """(h, w, 3) RGB of how an environment stands, for films of a task that no camera looks at, or
    none with a picture large enough"""
    claims: Sequence[Claim] = ()
    """what is claimed of its experiment's results"""
    plan_claims: Mapping[str, Sequence[Claim]] = field(default_factory=dict)
    """likewise of other plans than `full`, whose results lie in NAME-PLAN"""
    probes: Probes | None = None
    """what its gates are tested with"""

    def make(self, variant: str = "default") -> Environment:
        """A new environment; raises UnknownNameError."""
        if variant not in self.variants:
            raise UnknownNameError(f"variant of {self.name}", variant, self.variants)
        return self.variants[variant]()

    def make_expert(self, environment: Environment, name: str = SCRIPTED) -> Expert:
        """The expert, or who stands in for it by that name; raises UnknownNameError."""
        experts = {SCRIPTED: self.expert, **self.stand_ins}
        if name not in experts:
            raise UnknownNameError(f"expert of {self.name}", name, experts)
        return experts[name](environment)

    def make_for_run(self, variant: str, run_seed: int) -> Environment:
        """A new environment for the training run of that seed; raises UnknownNameError."""
        if variant in self.run_variants:
            return self.run_variants[variant](run_seed)
        if variant not in self.variants:
            known = (*self.variants, *self.run_variants)
            raise UnknownNameError(f"variant of {self.name}", variant, known)
        return self.make(variant)
