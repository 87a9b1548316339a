"""Experiments that are no single task's, by name: `sheath experiment NAME`."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

from sheath_manip.cli.aside import move_aside
from sheath_manip.cli.session import Session
from sheath_manip.exceptions import UnknownNameError


@dataclass(frozen=True)
class Asked:
    """What the line asks of a benchmark."""

    size: str
    """`full` or `quick`"""
    seeds: tuple[int, ...] | None
    """of the training runs; the plan's where None"""
    workers: int
    runs: Path
    results: Path
    fresh: bool
    """begin anew"""


def gates(asked: Asked, session: Session) -> None:
    """Every embedding with every support estimator, on every task that has probes."""
    tasks = session.tasks().values()
    # Only now: torch takes seconds to import.
    from sheath_manip.experiments.gates.benchmark import run_gates
    from sheath_manip.experiments.gates.plan import PLANS

    if asked.size not in PLANS:
        raise UnknownNameError("plan of gates", asked.size, PLANS)
    plan = PLANS[asked.size]
    if asked.seeds is not None:
        plan = replace(plan, seeds=asked.seeds)
    if asked.fresh:
        move_aside(asked.runs, session)
    run_gates(
        tasks,
        plan,
        runs=asked.runs,
        results=asked.results,
        command=session.command,
        workers=asked.workers,
        console=session.out,
    )


def nu(asked: Asked, session: Session) -> None:
    """Learning by the size of the support, on every task that has a plan for it."""
    tasks = session.tasks().values()
    # Only now: torch takes seconds to import.
    from sheath_manip.experiments.nu.benchmark import run_nu
    from sheath_manip.experiments.nu.plan import PLANS

    if asked.size not in PLANS:
        raise UnknownNameError("plan of nu", asked.size, PLANS)
    plan = PLANS[asked.size]
    if asked.seeds is not None:
        plan = replace(plan, seeds=asked.seeds)
    if asked.fresh:
        move_aside(asked.runs, session)
    run_nu(
        tasks,
        plan,
        runs=asked.runs,
        results=asked.results,
        command=session.command,
        workers=asked.workers,
        console=session.out,
    )


BENCHMARKS: dict[str, Callable[[Asked, Session], None]] = {"gates": gates, "nu": nu}
