"""How many nu are tried, and on which of a task's plans."""

import dataclasses
from dataclasses import dataclass
from typing import Any

from sheath_manip.exceptions import ParameterError
from sheath_manip.experiments.study import Study
from sheath_manip.learning.config import LearningPlan

METHOD = "sheath"


@dataclass(frozen=True)
class NuPlan:
    """The settings of the benchmark; the same plan and seed give the same result."""

    learning: str = "nu"
    """the task's plan that says what is demonstrated, fitted and run; tasks that offer no plan of
    that name take no part. Its gate should be the support alone at its own boundary, since any
    other threshold undoes what nu does"""
    nus: tuple[float, ...] = (0.01, 0.05, 0.1, 0.2, 0.5)
    """bounds on the share of training states that the support leaves outside. The draft's section
    IV-B calls nu the mass inside: its large nu are the small ones here"""
    seeds: tuple[int, ...] | None = None
    """of training runs; the task's plan's where None"""

    def __post_init__(self) -> None:
        if not self.nus or not all(0 < nu <= 1 for nu in self.nus):
            raise ParameterError(f"nus are {self.nus}; wanted some, each above 0 and at most 1")
        if self.seeds == ():
            raise ParameterError("seeds is empty; wanted at least one")

    def described(self) -> dict[str, Any]:
        """Return the plan as plain values, for summaries."""
        return dataclasses.asdict(self)

    def of(self, study: Study, nu: float) -> LearningPlan:
        """Return what runs on the study's task for one nu."""
        plan = study.plans[self.learning].changed(
            gate={"support": {"nu": nu}}, comparison={"methods": (METHOD,)}
        )
        return plan if self.seeds is None else plan.changed(comparison={"seeds": self.seeds})


PLANS = {"full": NuPlan(), "quick": NuPlan(learning="nu-quick", nus=(0.05, 0.5))}
