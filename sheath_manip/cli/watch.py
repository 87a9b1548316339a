"""`sheath dashboard`: episode after episode in the browser, at the pace of the task."""

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from itertools import count
from pathlib import Path
from typing import Annotated

from sheath_manip.cli.computing import Computing
from sheath_manip.cli.options import WITHOUT_PREFIX, Address, TaskName, default_is
from sheath_manip.cli.session import Session, at_least_one
from sheath_manip.cockpit import Cockpit
from sheath_manip.rollout.pacing import Pacing
from sheath_manip.seeding import scene_seed
from sheath_manip.types import EpisodeInfo, Purpose, TaskSpec


@dataclass(frozen=True, kw_only=True)
class Watch:
    """Watch a policy under its gate, or the scripted expert, in the browser until Ctrl-C.

    Nothing is recorded.
    """

    task: TaskName
    """name of the task, as `sheath tasks` lists it, or its place, `file.py:TASK`"""
    checkpoint: Annotated[Path | None, default_is("the expert drives")] = None
    """file of the policy and its gate"""
    store: Annotated[Path | None, default_is("no support is shown")] = None
    """directory of the episodes that the policy was trained on: shows its support, and lets ν be
    changed"""
    episodes: Annotated[int | None, default_is("until it is stopped")] = None
    """number of episodes after which to end"""
    seed: int = 0
    """seed from which the scenes follow"""
    variant: str = "default"
    """variant of the task"""
    speed: float = 1.0
    """speed of the run: 1 is the task's control rate, 2 twice as fast"""
    deadline: float = 1.0
    """share of the control period after which policy and gate are late, so that the expert acts;
    then a call that hangs is broken off, too; 0 is none"""
    computing: Annotated[Computing, WITHOUT_PREFIX] = field(default_factory=Computing)
    address: Annotated[Address, WITHOUT_PREFIX] = field(default_factory=Address)

    def run(self, session: Session) -> int:
        """Run episodes for ever."""
        self.computing.begin()
        if self.episodes is not None:
            at_least_one("episodes", self.episodes)
        cockpit = Cockpit(paced=True)
        pacing = Pacing(self.speed, lambda: cockpit.speed)
        task = session.runnable(self.task)
        # Only now: torch takes seconds to import.
        from sheath_manip.cli.adjusting import adjusted, scenes_of
        from sheath_manip.cli.episodes import opened, run_all
        from sheath_manip.learning.checkpoint import load_checkpoint
        from sheath_manip.learning.drivers import ExpertAlone
        from sheath_manip.rollout.request import Driver, EpisodeRequest, TimedDriver
        from sheath_manip.rollout.serial import SerialExecutor
        from sheath_manip.rollout.watch import Deadline

        with opened(task, self.variant) as probe:
            spec = probe.spec
        driver: Driver = ExpertAlone()
        adjusting = None
        if self.checkpoint is not None:
            checkpoint = load_checkpoint(self.checkpoint, spec)
            session.remark(checkpoint.remark)
            with session.err.status("reading"):
                adjusting = adjusted(self.checkpoint, checkpoint, self.store, spec, scenes_of(task))
            driver = adjusting.driver
        if self.deadline:
            driver = TimedDriver(driver, Deadline(self.deadline / self.speed))
        widgets = () if adjusting is None else adjusting.widgets
        explainer = None if adjusting is None else adjusting.explainer
        with (
            SerialExecutor() as executor,
            self.address.dashboard(spec, session, cockpit, widgets, explainer) as page,
            suppress(KeyboardInterrupt),
        ):
            if adjusting is not None and adjusting.states is not None:
                page.on_fit(adjusting.states)
            requests = (EpisodeRequest(task, info, driver) for info in self._infos(spec))
            for record in run_all(executor, requests, listeners=(page, pacing)):
                session.out.print(f"scene {record.seed}: {record.outcome}")
        return 0

    def _infos(self, spec: TaskSpec) -> Iterator[EpisodeInfo]:
        for index in count() if self.episodes is None else range(self.episodes):
            yield EpisodeInfo.of(
                spec,
                variant=self.variant,
                seed=scene_seed(Purpose.LEARNING, "dashboard", self.seed, index),
                purpose=Purpose.LEARNING,
                method="dashboard",
                index=index,
                run_seed=self.seed,
            )
