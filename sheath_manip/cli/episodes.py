"""Episodes for a verb: run, or read where the store has them; and tables of what they showed."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict
from math import isnan

from rich.table import Table
from rich.text import Text

from sheath_manip.burden import burden_of
from sheath_manip.cli.session import Session
from sheath_manip.cli.where import Where
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import ParameterError
from sheath_manip.metrics import (
    EpisodeRecord,
    endings,
    expert_share,
    figures_of,
    limited_share,
    record_of,
)
from sheath_manip.protocols import Environment, Listener, Report
from sheath_manip.rollout.executor import Executor, unheard
from sheath_manip.rollout.request import EpisodeRequest
from sheath_manip.task import Task
from sheath_manip.types import Episode


@contextmanager
def opened(task: Task, variant: str, run_seed: int = 0) -> Iterator[Environment]:
    """An environment of the task, closed at the end; of a run's own scene that of `run_seed`."""
    environment = task.make_for_run(variant, run_seed)
    try:
        yield environment
    finally:
        environment.close()


@contextmanager
def executor_of(where: Where, watched: bool = False) -> Iterator[Executor]:
    """Run episodes where the line says, by default in this process; ended at the end.

    ParameterError where a page or a person wants to follow into other processes.
    """
    executing = where.executing
    if watched and not executing.here:
        raise ParameterError(
            f"{executing}; a page and a person follow what runs in this process: wanted 0 workers"
        )
    executor = executing.made()
    try:
        yield executor
    finally:
        executor.close()


def run_all(
    executor: Executor,
    requests: Iterable[EpisodeRequest],
    store: EpisodeStore | None = None,
    listeners: Sequence[Listener] = (),
    report: Report = unheard,
    see: Callable[[Episode], None] = lambda _: None,
) -> Iterator[EpisodeRecord]:
    """Run each episode, or read it where `store` has it.

    `report` is told each outcome, and `see` is shown the whole episode.
    """
    for episode in executor.map(requests, store, listeners):
        report(str(episode.outcome))
        see(episode)
        yield record_of(episode)


def print_episodes(records: Sequence[EpisodeRecord], metric: str, session: Session) -> None:
    """Print one line an episode."""
    table = Table(box=None, pad_edge=False)
    table.add_column("scene seed", justify="right")
    table.add_column("outcome")
    for heading in (metric, "steps", "expert", "takeovers", "labels"):
        table.add_column(heading, justify="right")
    for record in records:
        table.add_row(
            str(record.seed),
            Text(record.outcome),
            f"{record.metrics.get(metric, float('nan')):.3g}",
            str(record.steps),
            f"{record.expert_steps / max(record.steps, 1):.0%}",
            str(record.interventions),
            str(record.queries),
        )
    session.out.print(table)


def print_figures(records: Sequence[EpisodeRecord], session: Session) -> None:
    """Rates and means with their 95 % intervals, and what was asked of the expert."""
    figures = figures_of(records)
    table = Table(box=None, pad_edge=False)
    for heading in (f"{figures.episodes} episodes", "mean", "95 % interval"):
        table.add_column(heading, justify="left" if heading[0].isdigit() else "right")
    metrics = {name: (mean, figures.ci95[name]) for name, mean in figures.metric.items()}
    for name, (mean, (low, high)) in {**endings(asdict(figures)), **metrics}.items():
        table.add_row(name, f"{mean:.3g}", f"{low:.3g} .. {high:.3g}")
    for name, value in asdict(burden_of(records)).items():
        # Where nobody took over nothing lasted; where no policy drove there is no minute of one.
        table.add_row(name, "–" if isnan(value) else f"{value:.3g}", "")
    table.add_row("expert_share", f"{expert_share(records):.3g}", "")
    if limited_share(records) > 0:
        table.add_row("limited_share", f"{limited_share(records):.3g}", "")
    session.out.print(table)
