"""`sheath learn`: rounds of learning by one method, with a scripted expert or with a person."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from rich.table import Table
from rich.text import Text

from sheath_manip.cli.aside import move_aside
from sheath_manip.cli.computing import Computing
from sheath_manip.cli.operated import PERSON, Crew, Operating
from sheath_manip.cli.options import WITHOUT_PREFIX, Address, TaskName, spec_of
from sheath_manip.cli.planned import Planned, asked_policy
from sheath_manip.cli.session import Session
from sheath_manip.cli.where import Where
from sheath_manip.cockpit.start import UntilReady
from sheath_manip.exceptions import UnknownNameError
from sheath_manip.gates.config import GateConfig
from sheath_manip.learning.config import Comparison, LearningPlan, Schedule
from sheath_manip.policies.config import PolicyConfig
from sheath_manip.protocols import Listener
from sheath_manip.task import SCRIPTED, Task
from sheath_manip.types import Purpose

if TYPE_CHECKING:
    from sheath_manip.rollout.request import Driver

ROUND_COLUMNS = (
    "round",
    "episodes",
    "takeovers an episode",
    "a minute",
    "s of driving",
    "share",
    "labels",
    "policy alone",
)
"""of the table that it ends with"""


@dataclass(frozen=True, kw_only=True)
class Learn(Planned):
    """Teach a policy in rounds: it drives under its gate, the expert helps, both are refitted.

    With a person as the expert it is asked on the page where the gate wants one, and only what it
    drove itself is learned from. Stopped anywhere and called again, it goes on where it was.
    Defaults are the plan's: `sheath learn TASK --plan NAME --help` prints them.
    """

    task: TaskName
    """name of the task, as `sheath tasks` lists it, or its place, `file.py:TASK`"""
    runs: Path
    """directory for the store, the checkpoints and what each round showed"""
    fresh: bool = False
    """begin anew and move aside what an earlier run left"""
    expert: str = SCRIPTED
    """expert to learn from: scripted, or a person at the page"""
    demonstrator: str = SCRIPTED
    """expert that gives the first demonstrations and the held-out ones for the threshold: scripted,
    or a person as well"""
    method: str = "sheath-own-labels"
    """method, as `sheath tasks` lists it; with hg-dagger only the person says when it drives"""
    plan: str = "full"
    """name of the plan of settings, as `sheath tasks` lists it"""
    policy: PolicyConfig = field(default_factory=PolicyConfig)
    gate: GateConfig = field(default_factory=GateConfig)
    schedule: Annotated[Schedule, WITHOUT_PREFIX] = field(default_factory=Schedule)
    evaluation_episodes: int = Comparison.evaluation_episodes
    """scenes on which the policy alone is judged after each round"""
    final_episodes: int = Comparison.final_episodes
    """scenes on which the last policy is judged"""
    failures: bool = False
    """learn also from expert episodes that did not succeed, by what was recorded or marked"""
    seed: int = 0
    """seed of the training run"""
    computing: Annotated[Computing, WITHOUT_PREFIX] = field(default_factory=Computing)
    where: Annotated[Where, WITHOUT_PREFIX] = field(default_factory=Where)
    dashboard: bool = False
    """show the run in the browser; with a person it always is"""
    operating: Annotated[Operating, WITHOUT_PREFIX] = field(default_factory=Operating)
    address: Annotated[Address, WITHOUT_PREFIX] = field(default_factory=Address)

    @property
    def size(self) -> str:
        """Name of the plan."""
        return self.plan

    @classmethod
    def settings(cls, plan: LearningPlan) -> dict[str, Any]:
        """Return what `plan` says of policy, gate, rounds and scenes."""
        return {
            "policy": plan.policy,
            "gate": plan.gate,
            "schedule": plan.schedule,
            "evaluation_episodes": plan.comparison.evaluation_episodes,
            "final_episodes": plan.comparison.final_episodes,
        }

    def run(self, session: Session) -> int:
        """Run all rounds, then print what each showed."""
        self.computing.begin()
        task = session.runnable(self.task)
        for name in (self.expert, self.demonstrator):
            if name not in (SCRIPTED, PERSON):
                raise UnknownNameError("expert to learn from", name, (SCRIPTED, PERSON))
        if PERSON in (self.expert, self.demonstrator):
            with self.operating.crew(task, self.address, session) as crew:
                crew.page.saved_in = str(self.runs)
                return self._run(crew.operated(), session, self._beside(crew), crew.driver)
        self.operating.require_default()
        with self._page(task, session) as listeners:
            return self._run(task, session, listeners, None)

    def _beside(self, crew: Crew) -> Sequence[Listener]:
        """The crew's listeners, and what waits for the person before its first episode."""
        purposes = {Purpose.LEARNING} if self.expert == PERSON else set[Purpose]()
        if self.demonstrator == PERSON:
            purposes |= {Purpose.DEMONSTRATION, Purpose.CALIBRATION}
        page, *others = crew.listeners
        return page, UntilReady(crew.cockpit, purposes), *others

    @contextmanager
    def _page(self, task: Task, session: Session) -> Iterator[Sequence[Listener]]:
        if not self.dashboard:
            yield ()
            return
        with self.address.dashboard(spec_of(task), session) as page:
            page.saved_in = str(self.runs)
            yield (page,)

    def _run(
        self,
        task: Task,
        session: Session,
        listeners: Sequence[Listener],
        operated: "Callable[[Driver], Driver] | None",
    ) -> int:
        offered = session.study(self.task).plan(self.plan)
        comparison = replace(
            offered.comparison,
            methods=(self.method,),
            seeds=(self.seed,),
            evaluation_episodes=self.evaluation_episodes,
            final_episodes=self.final_episodes,
        )
        policy = asked_policy(self.policy, offered)
        # Only now: torch takes seconds to import.
        from sheath_manip.burden import burden_of
        from sheath_manip.cli.episodes import executor_of, opened
        from sheath_manip.dataset.store import EpisodeStore
        from sheath_manip.experiments.progress import Stopwatch
        from sheath_manip.learning.beforehand import require_learnable, with_final_variant
        from sheath_manip.learning.demonstrations import left_out_line
        from sheath_manip.learning.results import round_path
        from sheath_manip.learning.resuming import require_same_plan
        from sheath_manip.learning.run import LearningRun
        from sheath_manip.learning.suited import suited
        from sheath_manip.metrics import endings_line, expert_share

        plan = with_final_variant(task, LearningPlan(policy, self.gate, self.schedule, comparison))
        with opened(task, plan.schedule.variant, self.seed) as probe:
            plan, line = suited(probe.spec, plan)
            session.remark(line)
            require_learnable(probe.spec, plan, comparison.methods)
        if self.fresh:
            move_aside(self.runs, session)
        self.runs.mkdir(parents=True, exist_ok=True)
        described = plan.described() | ({"failures": True} if self.failures else {})
        require_same_plan(described, self.runs / "plan.json")
        wall = self.runs / "wall.json"
        with (
            executor_of(self.where, bool(listeners)) as executor,
            session.progress(
                "episodes and fits", plan.units_of_run(), Stopwatch(wall).tick, listeners
            ) as report,
        ):
            learning = LearningRun(
                task,
                plan,
                self.seed,
                self.runs,
                EpisodeStore.create(self.runs / "store"),
                executor,
                listeners,
                report,
                supervised=operated if self.expert == PERSON else None,
                demonstrated=operated if self.demonstrator == PERSON else None,
                failures=self.failures,
            )
            results = learning.run(self.method)
        table = Table(box=None, pad_edge=False)
        for heading in ROUND_COLUMNS:
            table.add_column(heading, justify="right")
        for result in results:
            burden = burden_of(result.executed)
            table.add_row(
                str(result.round),
                endings_line(record.outcome for record in result.executed),
                f"{burden.takeovers_an_episode:.1f}",
                f"{burden.takeovers_a_minute:.1f}",
                f"{burden.driving_s_an_episode:.1f}",
                f"{expert_share(result.executed):.0%}",
                str(sum(record.queries for record in result.executed)),
                endings_line(record.outcome for record in result.policy),
            )
        session.out.print(table)
        last = round_path(self.runs, self.seed, results[-1].method, results[-1].round, "npz")
        session.out.print(Text(f"the last policy and its gate: {last}"))
        if learning.left_out:
            session.out.print(Text(left_out_line(learning.left_out)))
        return 0
