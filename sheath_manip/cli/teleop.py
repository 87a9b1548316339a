"""`sheath teleop`: demonstrations by hand."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

from rich.text import Text

from sheath_manip.cli.operated import PERSON, Operating
from sheath_manip.cli.options import WITHOUT_PREFIX, Address, TaskName
from sheath_manip.cli.session import Session, at_least_one
from sheath_manip.cockpit.start import UntilTaken
from sheath_manip.gates.patient import RequestConfig
from sheath_manip.seeding import scene_seed
from sheath_manip.task import HOLD, SCRIPTED
from sheath_manip.types import EpisodeInfo, Purpose, TaskSpec


@dataclass(frozen=True, kw_only=True)
class Teleop:
    """Record demonstrations that a person drives in the browser, but for those already there.

    An episode begins when the person takes over; one that is discarded is begun again.
    """

    task: TaskName
    """name of the task, as `sheath tasks` lists it, or its place, `file.py:TASK`"""
    store: Path
    """directory for the episodes; made where there is none"""
    episodes: int = 5
    """number of scenes of which the store shall hold a demonstration"""
    seed: int = 0
    """seed from which the scenes follow"""
    variant: str = "default"
    """variant of the task"""
    speed: float = 1.0
    """speed of the run: 1 is the task's control rate; the page's slider multiplies it"""
    spacemouse: bool = False
    """read the SpaceMouse that is plugged in here"""
    address: Annotated[Address, WITHOUT_PREFIX] = field(default_factory=Address)

    def run(self, session: Session) -> int:
        """Record them, then print the outcomes."""
        at_least_one("episodes", self.episodes)
        task = session.runnable(self.task)
        # Nobody else demonstrates: what a person leaves, the robot holds.
        fallback = HOLD if HOLD in task.fallbacks else SCRIPTED
        # Nor is anybody spared: who takes over often goes on demonstrating.
        unlimited = RequestConfig()
        operating = Operating(
            fallback, float("inf"), self.speed, self.spacemouse, requests=unlimited
        )
        # Only now: other verbs need no store.
        from sheath_manip.cli.episodes import print_figures, run_all
        from sheath_manip.dataset.sessions import begun, new_session
        from sheath_manip.dataset.store import EpisodeStore
        from sheath_manip.learning.drivers import ExpertAlone
        from sheath_manip.metrics import endings_line
        from sheath_manip.rollout.request import EpisodeRequest
        from sheath_manip.rollout.serial import SerialExecutor

        with operating.crew(task, self.address, session) as crew:
            operated, crew.page.saved_in = crew.operated(), str(self.store)
            start = UntilTaken(crew.cockpit)
            store, driver = EpisodeStore.create(self.store), crew.driver(ExpertAlone())
            requests = [
                EpisodeRequest(operated, info, driver)
                for info in begun(store, self._infos(crew.post.spec), new_session())
            ]
            with SerialExecutor() as executor:
                records = list(
                    run_all(
                        executor,
                        requests,
                        store,
                        (crew.page, start, *crew.listeners[1:]),
                        lambda word: session.err.print(Text(f"episode: {word}")),
                    )
                )
        print_figures(records, session)
        counts = endings_line(record.outcome for record in records)
        session.out.print(Text(f"{counts}; in {self.store}"))
        return 0

    def _infos(self, spec: TaskSpec) -> list[EpisodeInfo]:
        method = PERSON if self.variant == "default" else f"{PERSON}-{self.variant}"
        return [
            EpisodeInfo.of(
                spec,
                variant=self.variant,
                seed=scene_seed(Purpose.DEMONSTRATION, "by hand", self.seed, index),
                purpose=Purpose.DEMONSTRATION,
                method=method,
                index=index,
                run_seed=self.seed,
            )
            for index in range(self.episodes)
        ]
