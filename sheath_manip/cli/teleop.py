"""`sheath teleop`: demonstrations by hand."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated

from rich.text import Text

from sheath_manip.cli.operated import HOLD, PERSON, Operating
from sheath_manip.cli.options import WITHOUT_PREFIX, Address, TaskName
from sheath_manip.cli.session import Session, at_least_one
from sheath_manip.cockpit.start import UntilTaken
from sheath_manip.seeding import scene_seed
from sheath_manip.task import SCRIPTED
from sheath_manip.types import EpisodeInfo, Purpose, TaskSpec


@dataclass(frozen=True, kw_only=True)
class Teleop:
    """Record demonstrations that a person drives in the browser, but for those already there.

    An episode begins when the person takes over; one that is discarded is begun again.
    """

    task: TaskName
    """name of the task, as `sheath tasks` lists it"""
    store: Path
    """directory for the episodes; made where there is none"""
    episodes: int = 5
    """how many the store shall hold"""
    seed: int = 0
    """from which the scenes follow"""
    variant: str = "default"
    """of the task"""
    speed: float = 1.0
    """1 is the task's control rate; the page's slider multiplies it"""
    spacemouse: bool = False
    """read the SpaceMouse that is plugged in here"""
    address: Annotated[Address, WITHOUT_PREFIX] = field(default_factory=Address)

    def run(self, session: Session) -> int:
        """Record them, then print the outcomes."""
        at_least_one("episodes", self.episodes)
        task = session.task(self.task)
        # Nobody else demonstrates: what a person leaves, the robot holds.
        fallback = HOLD if HOLD in task.stand_ins else SCRIPTED
        operating = Operating(fallback, float("inf"), self.speed, self.spacemouse)
        # Only now: other verbs need no store.
        from sheath_manip.cli.episodes import opened, print_figures, run_all
        from sheath_manip.dataset.store import EpisodeStore
        from sheath_manip.gates.constant import AlwaysExpert

        with operating.crew(task, self.address, session) as crew:
            operated = crew.operated()
            start = UntilTaken(crew.cockpit)
            with opened(operated, self.variant) as environment:
                store = EpisodeStore.create(self.store)
                records = []
                for record in run_all(
                    environment,
                    self._infos(environment.spec),
                    crew.gate(AlwaysExpert()),
                    expert=operated.expert(environment),
                    store=store,
                    listeners=(crew.page, start, *crew.listeners[1:]),
                    report=lambda word: session.err.print(Text(f"episode: {word}")),
                ):
                    records.append(record)
        print_figures(records, session)
        outcomes = Counter(record.outcome for record in records)
        counts = ", ".join(f"{count} {outcome}" for outcome, count in outcomes.items())
        session.out.print(Text(f"{counts}; in {self.store}"))
        return 0

    def _infos(self, spec: TaskSpec) -> Iterator[EpisodeInfo]:
        method = PERSON if self.variant == "default" else f"{PERSON}-{self.variant}"
        first = EpisodeInfo(
            task=spec.name,
            seed=0,
            purpose=Purpose.DEMONSTRATION,
            control_rate_hz=spec.control_rate_hz,
            method=method,
            run_seed=self.seed,
        )
        for index in range(self.episodes):
            seed = scene_seed(Purpose.DEMONSTRATION, "by hand", self.seed, index)
            yield replace(first, seed=seed, index=index)
