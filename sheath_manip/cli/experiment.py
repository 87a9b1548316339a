"""`sheath experiment`: rounds of learning by several methods on a task, or a benchmark."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

from sheath_manip.cli.aside import move_aside
from sheath_manip.cli.benchmarks import BENCHMARKS, Asked
from sheath_manip.cli.comparing import Comparing
from sheath_manip.cli.options import WITHOUT_PREFIX, Address, default_is, spec_of
from sheath_manip.cli.own_tasks import is_reference
from sheath_manip.cli.planned import Planned, asked_policy
from sheath_manip.cli.session import OWN_TASK, Session, Verb
from sheath_manip.exceptions import ParameterError, UnknownNameError
from sheath_manip.experiments.study import Study
from sheath_manip.gates.config import GateConfig
from sheath_manip.learning.config import Comparison, LearningPlan, Schedule
from sheath_manip.policies.config import PolicyConfig
from sheath_manip.rollout.executing import Executing


@dataclass(frozen=True, kw_only=True)
class Benchmark(Comparing):
    """Compare gates (`gates`, `takeovers`) or sizes of the support (`nu`), on all tasks that do.

    Stopped anywhere and called again, it goes on where it was.
    """

    seeds: Annotated[tuple[int, ...] | None, default_is("from the plan")] = None
    """seeds of the training runs"""
    tasks: Annotated[tuple[str, ...] | None, default_is("from the plan")] = None
    """tasks to run on; what the results of `takeovers` hold of others stays there"""

    def run(self, session: Session) -> int:
        """Run it to its end."""
        self.computing.begin()
        if self.seeds == ():
            raise ParameterError("seeds is empty; wanted at least one")
        if self.tasks == ():
            raise ParameterError("tasks is empty; wanted at least one")
        runs, results = self.directories(self.task)
        asked = Asked(
            self.size, self.seeds, self.tasks, self.executing(), runs, results, self.fresh
        )
        BENCHMARKS[self.task](asked, session)
        return 0


@dataclass(frozen=True, kw_only=True)
class Experiment(Comparing, Planned):
    """Compare the methods on a task: demonstrations, rounds, held-out scenes, table and figures.

    The experiment `gates` compares gates instead, on all tasks that have probes, `takeovers` holds
    gates against what calls the expert as often and looks at nothing, and `nu` compares the sizes
    of the support, on all tasks that have a plan for it.

    Stopped anywhere and called again, it goes on where it was. Defaults are the plan's:
    `sheath experiment TASK --plan NAME --help` prints them.
    """

    policy: PolicyConfig = field(default_factory=PolicyConfig)
    gate: GateConfig = field(default_factory=GateConfig)
    schedule: Annotated[Schedule, WITHOUT_PREFIX] = field(default_factory=Schedule)
    comparison: Annotated[Comparison, WITHOUT_PREFIX] = field(default_factory=Comparison)
    figures: Annotated[tuple[str, ...] | None, default_is("all")] = None
    """file names of the figures to draw"""
    estimate: bool = False
    """say how long the run would take on how many cores and devices, from a trial of some minutes
    on one core, and run nothing else"""
    dashboard: bool = False
    """show the run in the browser, and run all in this process"""
    hold: bool = False
    """keep the page open after the end, until Ctrl-C; needs --dashboard"""
    address: Annotated[Address, WITHOUT_PREFIX] = field(default_factory=Address)

    @classmethod
    def named(cls, name: str) -> type[Verb]:
        """Return what a benchmark takes where it is one."""
        return Benchmark if name in BENCHMARKS else cls

    @classmethod
    def settings(cls, plan: LearningPlan) -> dict[str, Any]:
        """Return the settings, which are all of `plan`."""
        return {name: getattr(plan, name) for name in ("policy", "gate", "schedule", "comparison")}

    def run(self, session: Session) -> int:
        """Run it to its end."""
        self.computing.begin()
        if not is_reference(self.task) and self.task not in (tasks := session.catalog().tasks):
            raise UnknownNameError("experiment", self.task, (*tasks, *BENCHMARKS), OWN_TASK)
        session.runnable(self.task)
        study = session.study(self.task)
        policy = asked_policy(self.policy, study.plan(self.size))
        plan = LearningPlan(policy, self.gate, self.schedule, self.comparison)
        if self.figures == ():
            raise ParameterError("figures is empty; wanted at least one")
        executing = self.executing()
        runs, results = self.directories(study.name)
        if self.estimate:
            return self._estimate(study, plan, runs.with_name(f"{runs.name}-estimate"), session)
        # Only now: torch takes seconds to import.
        from sheath_manip.experiments.learning import run_experiment
        from sheath_manip.learning.methods import method_named

        for method in plan.comparison.methods:
            method_named(method)
        with self.address.listeners(self.dashboard, spec_of(study.task), session) as listeners:
            for dashboard in listeners:
                dashboard.saved_in = f"{runs}, with summary and figures in {results}"
            if self.fresh:
                move_aside(runs, session)
            run_experiment(
                study,
                plan,
                runs=runs,
                results=results,
                command=session.command,
                executing=executing,
                figures=self.figures,
                listeners=listeners,
                console=session.out,
            )
            if self.hold:
                for dashboard in listeners:
                    session.out.print("the page stays open until Ctrl-C")
                    dashboard.hold_open()
        return 0

    @staticmethod
    def _estimate(study: Study, plan: LearningPlan, directory: Path, session: Session) -> int:
        # Only now: torch takes seconds to import.
        from sheath_manip.experiments.scale.costs import trial_of
        from sheath_manip.experiments.scale.estimate import estimated_costs, print_estimate

        with session.progress("a small run", trial_of(plan).units()) as report:
            costs = estimated_costs(study, plan, directory, report)
        print_estimate(costs, plan, session.out)
        return 0

    def executing(self) -> Executing:
        """Return where episodes run: with a page in this process only."""
        if not self.dashboard:
            return super().executing()
        asked = self.where.executing
        if not asked.here:
            raise ParameterError(
                f"{asked}; the page shows what runs in this process, "
                "so wanted 0 workers (or nothing) with --dashboard"
            )
        return Executing(workers=0)
