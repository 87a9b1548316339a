"""`sheath run --robots N`: several robots, served one after another at one page."""

from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from rich.table import Table
from rich.text import Text

from sheath_manip.cli.asked import rows
from sheath_manip.cli.episodes import print_episodes, print_figures
from sheath_manip.cli.operated import Operating
from sheath_manip.cli.options import Address
from sheath_manip.cli.session import Session
from sheath_manip.dataset.background import BackgroundRecorder
from sheath_manip.dataset.compatibility import RecordedSpec
from sheath_manip.dataset.naming import episode_name
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import WorkerError
from sheath_manip.fleet.fleet import Fleet, Ran
from sheath_manip.fleet.fleet_cockpit import FleetCockpit
from sheath_manip.metrics import EpisodeRecord, endings_line, record_of
from sheath_manip.rollout.asked import AskedInEpisode, asked_in, asked_in_all
from sheath_manip.rollout.request import EpisodeRequest
from sheath_manip.task import Task
from sheath_manip.types import Outcome

if TYPE_CHECKING:
    from sheath_manip.dashboard import Dashboard
    from sheath_manip.dashboard.explainer import Explainer


@dataclass(frozen=True, eq=False)
class FleetRun:
    """A run of several robots, and what it came to so far."""

    session: Session
    metric: str
    store: EpisodeStore | None
    records: dict[int, EpisodeRecord] = field(default_factory=dict)
    """by the episode's number, since they end in any order"""
    asked: dict[int, list[AskedInEpisode]] = field(default_factory=dict)
    """by the robot's number; 0 for what the store had already"""
    lost: list[str] = field(default_factory=list)

    def run(self, fleet: Fleet, requests: Sequence[EpisodeRequest]) -> None:
        """Run all that the store does not have, and record each as it ends: one writer for all."""
        missing: list[EpisodeRequest] = []
        for each in requests:
            if self.store is not None and self.store.has(each.info):
                episode = self.store.read(episode_name(each.info))
                self._count(Ran(each, 0, episode))
            else:
                missing.append(each)
        with ExitStack() as stack:
            report = stack.enter_context(self.session.progress("episodes", len(missing)))
            recorder = None
            if self.store is not None and missing:
                recorder = stack.enter_context(BackgroundRecorder(self.store))
            for ran in fleet.run(missing):
                if recorder is not None and ran.episode is not None:
                    recorder.on_end(ran.episode)
                self._count(ran, report)

    def print(self) -> None:
        """Print what the episodes showed, and what was asked at each robot and at all of them."""
        records = [self.records[index] for index in sorted(self.records)]
        print_episodes(records, self.metric, self.session)
        print_figures(records, self.session)
        asked = {f"robot {number}": found for number, found in sorted(self.asked.items()) if number}
        everything = [each for found in self.asked.values() for each in found]
        columns = {**asked, "all": everything}
        table = Table("", *columns, box=None, pad_edge=False)
        for column in table.columns[1:]:
            column.justify = "right"
        told = [rows(asked_in_all(found)) for found in columns.values()]
        for lines in zip(*told, strict=True):
            table.add_row(lines[0][0], *(value for _, value in lines))
        self.session.out.print(table)
        self.session.out.print(Text(endings_line(each.outcome for each in everything)))

    def _count(self, ran: Ran, report: Callable[[str], None] = lambda _: None) -> None:
        if ran.fault or ran.episode is None:
            self.lost.append(episode_name(ran.request.info))
            self.session.complain(f"robot {ran.robot}: {ran.fault}; the others go on")
            report(str(Outcome.ERROR))
            return
        self.records[ran.request.info.index] = record_of(ran.episode)
        self.asked.setdefault(ran.robot, []).append(asked_in(ran.episode))
        report(str(ran.episode.outcome))


def run_fleet(
    robots: int,
    task: Task,
    operating: Operating,
    address: Address,
    session: Session,
    explainer: "Explainer",
    requests: Sequence[EpisodeRequest],
    store: EpisodeStore | None,
    prepare: Callable[["Dashboard"], None],
) -> int:
    """Run the requests at so many robots, then print what each of them showed and asked.

    `prepare` is called with the page before anything runs. Raises WorkerError at the end where
    episodes are lost.
    """
    post = operating.post(task, float("inf"))
    if store is not None:
        store.require_fits(RecordedSpec.of_task(post.spec), "what is to be recorded")
    cockpit = FleetCockpit(robots, post.guide, post.fallback_shown, post.planar)
    run = FleetRun(session, post.spec.metric, store)
    with (
        operating.devices(cockpit),
        address.dashboard(
            post.spec, session, cockpit, explainer=explainer, pictures=cockpit.roster.pictures
        ) as page,
    ):
        prepare(page)
        cockpit.on_film = page.show
        with Fleet(post, cockpit, page.count) as fleet:
            run.run(fleet, requests)
    run.print()
    if run.lost:
        raise WorkerError(
            f"{len(run.lost)} of {len(requests)} episodes were lost ({', '.join(run.lost)}); the "
            "others are whole, and the same line again runs those that a store lacks"
        )
    return 0
