"""`sheath data list` and `sheath data check`: a store as a table on the terminal."""

from pathlib import Path

from rich.console import Console
from rich.progress import track
from rich.table import Table
from rich.text import Text

from sheath_manip.dataset.check import check_entries, check_episode
from sheath_manip.dataset.reader import EpisodeSummary
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import StoreError


def print_list(path: str | Path, console: Console) -> int:
    """Print one line an episode; return 1 where one cannot be read, else 0.

    Raises StoreError where `path` is no store.
    """
    store = EpisodeStore(path)
    table = Table(title=Text(str(store.path)), title_justify="left")
    table.add_column("episode", overflow="fold")
    for heading in ("task", "outcome"):
        table.add_column(heading)
    for heading in ("steps", "expert", "queries", "MB"):
        table.add_column(heading, justify="right")
    table.add_column("metrics", overflow="fold")
    summaries, broken = [], []
    for name in store.names():
        try:
            summaries.append(store.summary(name))
        except StoreError as error:
            broken.append(str(error))
    for summary in summaries:
        # As Text, because a task or a method may hold what rich takes for markup.
        table.add_row(*(Text(cell) for cell in _cells(summary)))
    console.print(table)
    steps = sum(summary.length for summary in summaries)
    megabytes = sum(summary.bytes for summary in summaries) / 1e6
    console.print(Text(f"{len(summaries)} episodes, {steps} steps, {megabytes:.1f} MB"))
    for line in broken:
        console.print(Text(line, style="red"))
    return 1 if broken else 0


def print_check(path: str | Path, console: Console) -> int:
    """Decompress the whole store and print its faults; return 1 where data is affected, else 0.

    Raises StoreError where `path` is no store.
    """
    store = EpisodeStore(path)
    faults, names = check_entries(store), store.names()
    for name in track(
        names, "checking", console=console, transient=True, disable=not console.is_terminal
    ):
        faults += check_episode(store, name)
    damaging = [fault for fault in faults if fault.damaging]
    if faults:
        table = Table(title=Text(str(store.path)), title_justify="left")
        for heading in ("entry", "fault", "what"):
            table.add_column(heading, overflow="fold")
        for fault in faults:
            style = "red" if fault.damaging else "yellow"
            table.add_row(*(Text(cell, style) for cell in (fault.name, fault.kind, fault.text)))
        console.print(table)
    leftovers = len(faults) - len(damaging)
    console.print(
        Text(f"{len(names)} episodes, {len(damaging)} faults, {leftovers} harmless leftovers")
    )
    return 1 if damaging else 0


def _cells(summary: EpisodeSummary) -> tuple[str, ...]:
    return (
        summary.name,
        summary.info.task,
        summary.outcome,
        str(summary.length),
        f"{summary.expert_share:.0%}",
        str(summary.queries),
        f"{summary.bytes / 1e6:.2f}",
        ", ".join(f"{name} {value:.4g}" for name, value in summary.metrics.items()),
    )
