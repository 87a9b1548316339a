"""What cannot be learned on a task, told before its first episode is run."""

from collections.abc import Iterable

from sheath_manip.exceptions import UnknownNameError
from sheath_manip.gates.config import GateConfig, planned_signal
from sheath_manip.gates.making import GATES
from sheath_manip.learning.config import Comparison, LearningPlan
from sheath_manip.learning.methods import method_named
from sheath_manip.policies import make_policy
from sheath_manip.policies.config import PolicyConfig
from sheath_manip.policies.readings import require_cameras
from sheath_manip.signals import make_signal
from sheath_manip.task import Task
from sheath_manip.types import TaskSpec


def require_makeable(spec: TaskSpec, policy: PolicyConfig, gate: GateConfig | None) -> None:
    """Make policy and signal once, and fit nothing; the signal only where there is a `gate`.

    Raises UnknownNameError and ParameterError where they cannot be made for the task, as far as
    that shows before anything is looked at.
    """
    made = make_policy(policy.name, spec, **policy.settings)
    if gate is not None:
        require_cameras(make_signal(planned_signal(gate)).attach(made), spec)


def require_learnable(spec: TaskSpec, plan: LearningPlan, methods: Iterable[str]) -> None:
    """Make what `plan` begins with, and what each of the `methods` makes of it.

    Raises as `require_makeable` does, and UnknownNameError for a method that there is not.
    """
    for each in (plan, *(method_named(name).plan(plan) for name in methods)):
        looks = GATES[each.gate.kind].looks
        require_makeable(spec, each.policy, each.gate if looks else None)


def with_final_variant(task: Task, plan: LearningPlan) -> LearningPlan:
    """Return `plan`, its last policies judged on a variant that the task has.

    Where the task has none that is named `final`, on the one that is learned on. Raises
    UnknownNameError for another name that the task lacks.
    """
    known, wanted = (*task.variants, *task.run_variants), plan.comparison.final_variant
    if wanted in known:
        return plan
    if wanted != Comparison.final_variant:
        raise UnknownNameError(f"variant of {task.name}", wanted, known)
    return plan.changed(comparison={"final_variant": plan.schedule.variant})
