"""What a paper needs of a task: plans of learning, baselines, probes, figures and claims."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from sheath_manip.exceptions import UnknownNameError
from sheath_manip.experiments.claims import Claim
from sheath_manip.experiments.probes import Probes
from sheath_manip.learning.config import LearningPlan
from sheath_manip.protocols import Expert
from sheath_manip.task import Task


def _default_plans() -> Mapping[str, LearningPlan]:
    return {"full": LearningPlan()}


@dataclass(frozen=True)
class Study:
    """What is learned on a task and told about it. Everything in it can be pickled.

    A task that has none is learned by `LearningPlan`'s defaults.
    """

    task: Task
    plans: Mapping[str, LearningPlan] = field(default_factory=_default_plans)
    """by name; `full` is used where none is asked for, `quick` takes minutes"""
    baselines: Mapping[str, Callable[[Any], Expert]] = field(default_factory=dict)
    """by name, from the environment: controllers that learn nothing, to hold the methods against
    on the final scenes"""
    probes: Probes | None = None
    """what the gates are tested with"""
    figures: Mapping[str, Callable[..., None]] = field(default_factory=dict)
    """figures of this task alone, by file name"""
    claims: Sequence[Claim] = ()
    """what is claimed of the results of the plan `full`"""
    plan_claims: Mapping[str, Sequence[Claim]] = field(default_factory=dict)
    """what is claimed of the results of other plans, which lie in NAME-PLAN"""

    @property
    def name(self) -> str:
        """The task's."""
        return self.task.name

    def plan(self, name: str) -> LearningPlan:
        """Return the plan of that name; raises UnknownNameError."""
        if name not in self.plans:
            raise UnknownNameError(f"plan of {self.name}", name, self.plans)
        return self.plans[name]
