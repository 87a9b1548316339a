"""Experiments that are no single task's, by name: `sheath experiment NAME`."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from sheath_manip.cli.aside import move_aside
from sheath_manip.cli.session import Session
from sheath_manip.exceptions import ParameterError, UnknownNameError
from sheath_manip.rollout.executing import Executing


@dataclass(frozen=True)
class Asked:
    """The line's options: what it asks of a benchmark."""

    size: str
    """`full` or `quick`"""
    seeds: tuple[int, ...] | None
    """Seeds of the training runs, the plan's where None."""
    tasks: tuple[str, ...] | None
    """Tasks, the plan's where None."""
    executing: Executing
    runs: Path
    results: Path
    fresh: bool
    """begin anew"""


def gates(asked: Asked, session: Session) -> None:
    """Every embedding with every support estimator, on every task that has probes."""
    # Only now: torch takes seconds to import.
    from sheath_manip.experiments.gates.benchmark import run_gates
    from sheath_manip.experiments.gates.plan import PLANS

    _run("gates", PLANS, run_gates, asked, session)


def nu(asked: Asked, session: Session) -> None:
    """Learning by the size of the support, on every task that has a plan for it."""
    # Only now: torch takes seconds to import.
    from sheath_manip.experiments.nu.benchmark import run_nu
    from sheath_manip.experiments.nu.plan import PLANS

    _run("nu", PLANS, run_nu, asked, session)


def takeovers(asked: Asked, session: Session) -> None:
    """Every gate beside baselines that call the expert as often, on every task."""
    # Only now: torch takes seconds to import.
    from sheath_manip.experiments.takeovers.benchmark import run_takeovers
    from sheath_manip.experiments.takeovers.plan import PLANS

    _run("takeovers", PLANS, run_takeovers, asked, session)


def _run(
    name: str,
    plans: Mapping[str, Any],
    run: Callable[..., object],
    asked: Asked,
    session: Session,
) -> None:
    """Run a benchmark at the asked size; UnknownNameError for one that it has no plan for."""
    if asked.size not in plans:
        raise UnknownNameError(f"plan of {name}", asked.size, plans)
    plan = plans[asked.size]
    if asked.seeds is not None:
        plan = replace(plan, seeds=asked.seeds)
    if asked.tasks is not None:
        if not hasattr(plan, "tasks"):
            raise ParameterError(
                f"{name} runs on every task that has a plan for it; wanted no --tasks"
            )
        plan = replace(plan, tasks=asked.tasks)
    if asked.fresh:
        move_aside(asked.runs, session)
    run(
        session.studies(),
        plan,
        runs=asked.runs,
        results=asked.results,
        command=session.command,
        executing=asked.executing,
        console=session.out,
    )


BENCHMARKS: dict[str, Callable[[Asked, Session], None]] = {
    "gates": gates,
    "nu": nu,
    "takeovers": takeovers,
}
