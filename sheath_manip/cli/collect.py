"""`sheath collect`: demonstrations by the task's scripted expert."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

from rich.text import Text

from sheath_manip.cli.options import WITHOUT_PREFIX, Address, TaskName
from sheath_manip.cli.session import Session, at_least_one
from sheath_manip.cli.where import Where


@dataclass(frozen=True, kw_only=True)
class Collect:
    """Record episodes of the scripted expert, but for those that the store holds already."""

    task: TaskName
    """name of the task, as `sheath tasks` lists it, or its place, `file.py:TASK`"""
    store: Path
    """directory for the episodes; made where there is none"""
    episodes: int = 20
    """number of episodes that the store shall hold"""
    seed: int = 0
    """seed from which the scenes follow"""
    variant: str = "default"
    """variant of the task"""
    where: Annotated[Where, WITHOUT_PREFIX] = field(default_factory=Where)
    dashboard: bool = False
    """show the run in the browser"""
    address: Annotated[Address, WITHOUT_PREFIX] = field(default_factory=Address)

    def run(self, session: Session) -> int:
        """Record them, then print the outcomes."""
        at_least_one("episodes", self.episodes)
        task = session.runnable(self.task)
        # Only now: other verbs need no store.
        from sheath_manip.cli.episodes import executor_of, opened, print_figures, run_all
        from sheath_manip.dataset.store import EpisodeStore
        from sheath_manip.learning.drivers import ExpertAlone
        from sheath_manip.learning.first_episodes import demonstration_info
        from sheath_manip.metrics import endings_line
        from sheath_manip.rollout.request import EpisodeRequest

        with opened(task, self.variant) as probe:
            spec = probe.spec
        with (
            self.address.listeners(self.dashboard, spec, session) as listeners,
            session.progress("demonstrations", self.episodes) as report,
            executor_of(self.where, self.dashboard) as executor,
        ):
            store = EpisodeStore.create(self.store)
            infos = [
                demonstration_info(spec, self.variant, self.seed, index)
                for index in range(self.episodes)
            ]
            held = sum(store.has(info) for info in infos)
            driver = ExpertAlone()
            requests = [EpisodeRequest(task, info, driver) for info in infos]
            records = list(run_all(executor, requests, store, listeners, report))
        print_figures(records, session)
        counts = endings_line(record.outcome for record in records)
        steps = sum(record.steps for record in records)
        line = f"{counts}; {steps} steps in {self.store}, {held} episodes of them from before"
        session.out.print(Text(line))
        return 0
