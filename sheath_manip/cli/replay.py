"""`sheath replay`: recorded episodes in the browser, or one of them as a file."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from rich.text import Text

from sheath_manip.cli.options import WITHOUT_PREFIX, Address, StoreAddress, default_is
from sheath_manip.cli.session import Session
from sheath_manip.exceptions import ParameterError, UnknownNameError
from sheath_manip.files.outputs import written_aside
from sheath_manip.protocols import Environment
from sheath_manip.task import Task
from sheath_manip.types import EpisodeInfo, TaskSpec

if TYPE_CHECKING:
    from sheath_manip.dashboard.catalog import EpisodeCatalog
    from sheath_manip.dashboard.explainer import Explainer
    from sheath_manip.gates.fitted import FittedGate
    from sheath_manip.playback.making import FilmMaker

KINDS = (".mp4", ".html")
IN_A_FILE = "a task in a file is replayed with --task file.py:TASK"


@dataclass(frozen=True, kw_only=True)
class Replay:
    """Look at recorded episodes in the browser until Ctrl-C: scrub, jump, mark, take along."""

    store: StoreAddress
    """directory of the episodes, or a URL"""
    beside: tuple[str, ...] = ()
    """directories or URLs of more episodes of the task, to choose moments from as well"""
    episode: str = "0"
    """episode to begin with: its name, or its place in `sheath data list`, from 0; -1 is the
    last"""
    task: Annotated[str | None, default_is("the one that the episode says")] = None
    """place of the task where no table has it, `file.py:TASK`: a recording says its name alone"""
    speed: float = 1.0
    """speed of the replay: 1 is the episode's control rate, 2 twice as fast"""
    variant: Annotated[str | None, default_is("the one that the episode says")] = None
    """variant of the task in which old episodes were recorded that do not say theirs"""
    checkpoint: Annotated[Path | None, default_is("what the steps have recorded is told alone")] = (
        None
    )
    """file of the policy and its gate that drove the episodes: the page then shows the training
    states most like a moment, and what another threshold would come to on held-out episodes"""
    training_store: Annotated[StoreAddress | None, default_is("the replayed one")] = None
    """directory or URL of the episodes that the checkpoint was trained on, for their images"""
    once: bool = False
    """end after the episodes were shown once"""
    export: Annotated[Path | None, default_is("a page is shown")] = None
    """write the episode to this .mp4 or .html file, and show no page"""
    address: Annotated[Address, WITHOUT_PREFIX] = field(default_factory=Address)

    def run(self, session: Session) -> int:
        """Replay, or export."""
        if not self.speed > 0:
            raise ParameterError(f"speed is {self.speed}; wanted more than 0, such as 1")
        if self.training_store is not None and self.checkpoint is None:
            raise ParameterError("--training-store is of a checkpoint; wanted --checkpoint, too")
        if self.export is not None and self.export.suffix not in KINDS:
            raise ParameterError(
                f"--export {self.export}; wanted a name that ends in .mp4 or .html"
            )
        # Only now: other verbs need no store and no page.
        from sheath_manip.dashboard.catalog import EpisodeCatalog
        from sheath_manip.dataset.locations import open_store
        from sheath_manip.dataset.show import chosen

        store = open_store(self.store)
        place = store.names().index(chosen(store, self.episode))
        catalog = EpisodeCatalog(store, *map(open_store, self.beside))
        self._require_use_of_variant([each.info.variant for each in catalog.summaries], session)
        task = self._task(catalog.summaries[place].info.task, session)
        with self._maker(task, catalog) as maker:
            if self.export is not None:
                self._export(maker, place, session)
            else:
                self._show(maker, catalog, place, task, session)
        return 0

    def _require_use_of_variant(self, recorded: Sequence[str], session: Session) -> None:
        """ParameterError where no episode would be shown in it; a line where only some would."""
        if self.variant is None:
            return
        own = sum(map(bool, recorded))
        if own == len(recorded):
            raise ParameterError(
                f"--variant {self.variant} is for old episodes that do not say theirs; all {own} "
                f"of {self.store} do, and are shown in it: leave it out"
            )
        if own:
            line = f"{own} of {len(recorded)} episodes say their own variant, and are shown in it"
            session.out.print(Text(line))

    def _task(self, recorded: str, session: Session) -> Task:
        """The task of the recorded name; nothing that a recording says is ever run as code."""
        if self.task is None:
            tasks = session.catalog().tasks
            if recorded not in tasks:
                raise UnknownNameError("task", recorded, tasks, IN_A_FILE)
            return tasks[recorded]
        task = session.task(self.task)
        if task.name != recorded:
            raise ParameterError(
                f"--task {self.task} is the task {task.name!r}; the episode is of {recorded!r}"
            )
        return task

    @contextmanager
    def _maker(self, task: Task, catalog: "EpisodeCatalog") -> Iterator["FilmMaker"]:
        from sheath_manip.playback.making import FilmMaker

        maker = FilmMaker(task, self.variant, catalog.read, catalog.summary)
        try:
            yield maker
        finally:
            maker.close()

    def _export(self, maker: "FilmMaker", place: int, session: Session) -> None:
        assert self.export is not None
        if self.export.exists():
            raise ParameterError(f"{self.export} exists, and it is kept; give another name")
        with session.err.status("drawing"):
            _, content = maker.exported(place, self.export.suffix.removeprefix("."))
        try:
            with written_aside(self.export, replacing=False) as aside:
                aside.write_bytes(content)
        except OSError as error:
            raise ParameterError(f"cannot write {self.export} ({error})") from error
        session.out.print(Text(f"{self.export}: {len(content) / 1e6:.2f} MB"))

    def _show(
        self,
        maker: "FilmMaker",
        catalog: "EpisodeCatalog",
        place: int,
        task: Task,
        session: Session,
    ) -> None:
        from sheath_manip.dashboard import Replay as ReplayPage

        # Before the page is there, so that what cannot be shown is told on the terminal.
        film = maker.film(place)
        if film.lacks:
            session.out.print(Text(film.lacks))
        self.address.warn(session)
        spec = maker.spec(place)
        with session.err.status("reading"):
            explainer, fitted = self._explaining(task, spec)
        page = ReplayPage(
            spec,
            catalog,
            maker.film,
            maker.exported,
            maker.clip,
            host=self.address.host,
            port=self.address.port,
            speed=self.speed,
            again=not self.once,
            explainer=explainer,
            fitted=fitted,
        )
        with page, suppress(KeyboardInterrupt):
            session.announce(page.address)
            steps = f"{len(catalog)} episodes, this one of {len(film)} steps"
            session.out.print(Text(f"{self.store}: {steps}, {film.outcome}"))
            page.run(place)

    def _explaining(self, task: Task, spec: TaskSpec) -> "tuple[Explainer, FittedGate | None]":
        """What says why the gate asked; CheckpointError where the checkpoint cannot be used."""
        from sheath_manip.dashboard.explainer import Explainer

        def make(info: EpisodeInfo) -> Environment:
            variant = info.variant or self.variant or "default"
            return task.make_for_run(variant, info.run_seed)

        if self.checkpoint is None:
            return Explainer(spec, None, make), None
        # Only now: torch takes seconds to import.
        from sheath_manip.dashboard.reference import GateReference
        from sheath_manip.dataset.locations import open_store

        reader = open_store(self.training_store or self.store)
        reference = GateReference.load(self.checkpoint, spec, reader)
        return Explainer(spec, lambda: reference, make), reference.fitted
