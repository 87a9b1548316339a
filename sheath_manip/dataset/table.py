"""`sheath data list` and `sheath data check`: a store as a table on the terminal."""

from collections.abc import Iterable, Sequence
from contextlib import suppress

from rich.console import Console
from rich.progress import track
from rich.table import Table
from rich.text import Text

from sheath_manip.dataset.check import check_episode
from sheath_manip.dataset.faults import FaultKind
from sheath_manip.dataset.locations import open_store
from sheath_manip.dataset.reader import EpisodeReader, EpisodeSummary
from sheath_manip.exceptions import StoreError
from sheath_manip.metrics import endings_line
from sheath_manip.printable import printable

HEADINGS = ("episode", "task", "outcome", "steps", "expert", "queries", "MB", "metrics")
MOST_ROWS = 1000
"""of a table; more are plain lines"""


def print_list(address: str, console: Console) -> int:
    """Print one line an episode; return 1 where one cannot be read, else 0.

    Raises StoreError where `address` is no store.
    """
    reader = open_store(address)
    summaries, broken = readable(reader)
    rows = map(_cells, summaries)
    if len(summaries) > MOST_ROWS:
        _print_plain(reader.address, list(rows), console)
    else:
        console.print(_table(reader.address, rows))
    console.print(Text(_totals(summaries)))
    for line in broken:
        console.print(Text(line, style="red"))
    return 1 if broken else 0


def _table(address: str, rows: Iterable[tuple[str, ...]]) -> Table:
    table = Table(title=Text(address), title_justify="left")
    for heading in HEADINGS:
        numbers = heading in ("steps", "expert", "queries", "MB")
        fold = heading in ("episode", "metrics")
        table.add_column(
            heading,
            justify="right" if numbers else "left",
            overflow="fold" if fold else "ellipsis",
        )
    for row in rows:
        # As Text, because a task or a method may hold what rich takes for markup.
        table.add_row(*map(Text, row))
    return table


def _print_plain(address: str, rows: Sequence[tuple[str, ...]], console: Console) -> None:
    """Print a line a row, however long: a table of rich takes a millisecond for each."""
    rows = [
        HEADINGS,
        *(tuple(printable(cell).replace("\n", "\\n") for cell in row) for row in rows),
    ]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = ["  ".join(map(str.ljust, row, widths)).rstrip() for row in rows]
    console.file.write("\n".join([printable(address), *lines, ""]))


def readable(reader: EpisodeReader) -> tuple[list[EpisodeSummary], list[str]]:
    """The episodes whose header can be read, and a line for each of the others."""
    summaries, broken = [], []
    for summary in reader.summaries():
        if isinstance(summary, StoreError):
            broken.append(str(summary))
        else:
            summaries.append(summary)
    return summaries, broken


def print_check(address: str, console: Console) -> int:
    """Decompress the whole store and print its faults; return 1 where data is affected, else 0.

    Raises StoreError where `address` is no store.
    """
    reader = open_store(address)
    faults, names, without_digest = reader.entry_faults(), reader.names(), 0
    for name in track(
        names, "checking", console=console, transient=True, disable=not console.is_terminal
    ):
        faults += check_episode(reader, name)
        with suppress(StoreError):
            without_digest += reader.header(name).digests is None
    damaging = [fault for fault in faults if fault.damaging]
    if faults:
        table = Table(title=Text(reader.address), title_justify="left")
        for heading in ("entry", "fault", "what"):
            table.add_column(heading, overflow="fold")
        for fault in faults:
            style = "red" if fault.damaging else "yellow"
            table.add_row(*(Text(cell, style) for cell in (fault.name, fault.kind, fault.text)))
        console.print(table)
    remarks = sum(fault.kind is FaultKind.REMARK for fault in faults)
    leftovers = len(faults) - len(damaging) - remarks
    line = f"{len(names)} episodes, {len(damaging)} faults, {leftovers} harmless leftovers"
    console.print(Text(line + f", {remarks} remarks" * bool(remarks)))
    if without_digest:
        told = f"{without_digest} episodes have no digest: of before there was one"
        console.print(Text(f"{told}; a value changed together with its checksum is not found"))
    return 1 if damaging else 0


def _cells(summary: EpisodeSummary) -> tuple[str, ...]:
    return (
        summary.name,
        summary.info.task,
        _outcome(summary),
        str(summary.length),
        f"{summary.expert_share:.0%}",
        str(summary.queries),
        f"{summary.bytes / 1e6:.2f}",
        ", ".join(f"{name} {value:.4g}" for name, value in summary.metrics.items()),
    )


def _outcome(summary: EpisodeSummary) -> str:
    """With a star where a person marked it as something else, or some of it as bad."""
    marked = summary.outcome is not summary.recorded_outcome or summary.bad_steps
    return summary.outcome + "*" * bool(marked)


def _totals(summaries: Sequence[EpisodeSummary]) -> str:
    steps = sum(summary.length for summary in summaries)
    megabytes = sum(summary.bytes for summary in summaries) / 1e6
    line = f"{len(summaries)} episodes, {steps} steps, {megabytes:.1f} MB"
    if not summaries:
        return line
    ended = endings_line(summary.outcome for summary in summaries)
    expert = sum(summary.expert_share * summary.length for summary in summaries) / steps
    queries = sum(summary.queries for summary in summaries) / steps
    asked = f"the expert acted in {expert:.0%} of the steps, {queries:.0%} asked for a label"
    return f"{line}; {ended}; {asked}"
