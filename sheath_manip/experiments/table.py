"""An experiment as three tables: one row a method, below each figure its 95 % interval."""

from collections.abc import Mapping, Sequence
from typing import Any

from rich import box
from rich.console import Group
from rich.table import Table

from sheath_manip.experiments.burdens_table import burdens_table
from sheath_manip.experiments.endings import endings_table


def table(summary: Mapping[str, Any]) -> Group:
    """Return the tables of a summary, which fit a terminal of 80 columns.

    How episodes ended, then what they asked of the expert, and what they were worth.
    """
    return Group(endings_table(summary), burdens_table(summary), _figures(summary))


def _figures(summary: Mapping[str, Any]) -> Table:
    metric = summary["metric"]
    grid = Table(
        title=f"{summary['experiment']}: training seeds {seeds_shown(summary['seeds'])}",
        caption="run: what was executed in all rounds, the policy under its gate · alone: the last "
        "policy without gate, on held-out scenes · final: the same on the final variant · "
        "[not dim]dim[/not dim]: 95 % interval",
        title_justify="left",
        caption_justify="left",
        box=box.SIMPLE_HEAD,
        padding=0,
    )
    grid.add_column("\n\nmethod")
    words = str(metric).replace("_", "\n")
    alarms = "false\nalarms\n%"
    for header in (f"run:\n{words}", alarms, f"alone\n{words}", f"final\n{words}"):
        grid.add_column(header, justify="right", vertical="top")
    expert = summary["expert"]
    grid.add_row("expert", _mean(expert, metric), end_section=True)
    others = summary.get("references", {})
    for number, (name, figures) in enumerate(others.items(), 1):
        dashes = ["–"] * 3
        last = number == len(others)
        grid.add_row(name, *dashes, _mean(figures, metric), end_section=last)
    for name, method in summary["methods"].items():
        overall, last = method["overall"], method["rounds"][-1]
        grid.add_row(
            name.replace("-", "-\n"),
            _mean(overall, metric),
            _percent(overall["false_alarm_rate"]),
            _mean(last["policy"], metric),
            _mean(method["final"], metric),
        )
    return grid


def seeds_shown(seeds: Sequence[int]) -> str:
    """Return the seeds in a line: `0, 1, 2`, but `0..49` for more than four in a row."""
    if len(seeds) > 4 and list(seeds) == list(range(seeds[0], seeds[0] + len(seeds))):
        return f"{seeds[0]}..{seeds[-1]}"
    return ", ".join(map(str, seeds))


def with_interval(mean: float, ci95: Sequence[float]) -> str:
    """Two lines of a cell: the mean, and its interval in as few digits as tell it.

    One line where the interval has no width to be seen: as of a single value.
    """
    largest = max(map(abs, ci95))
    digits = 2 if largest <= 1 else 1 if largest < 10 else 0
    low, high = (f"{value:.{digits}f}" for value in ci95)
    if largest <= 1:
        low, high = (text.removeprefix("0").removesuffix(".00") for text in (low, high))
    shown = f"{mean:.{2 if abs(mean) < 100 else 1}f}"
    return shown if low == high else f"{shown}\n[dim]{low}–{high}[/dim]"


def _mean(figures: Mapping[str, Any], metric: str | None) -> str:
    if metric not in figures["metric"]:
        return "–"
    return with_interval(figures["metric"][metric], figures["ci95"][metric])


def _percent(value: float | None) -> str:
    return "–" if value is None else f"{100 * value:.1f}"
