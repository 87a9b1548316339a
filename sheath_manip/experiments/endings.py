"""How the episodes of an experiment ended, as one table: succeeded, failed and stuck apart."""

from collections.abc import Mapping
from typing import Any

from rich import box
from rich.table import Table

from sheath_manip.metrics import endings

HEADINGS = {"succeeded": "suc-\nceeded\n%", "failed": "failed\n\n%", "stuck": "stuck\n\n%"}
"""by the word; they fit three times into 80 columns"""
MEASURED = ("run", "alone", "final")


def endings_table(summary: Mapping[str, Any]) -> Table:
    """Return the table of a summary; it fits a terminal of 80 columns."""
    grid = Table(
        title=f"{summary['experiment']}: how episodes ended",
        caption="stuck: neither succeeded nor failed before the time limit",
        title_justify="left",
        caption_justify="left",
        box=box.SIMPLE_HEAD,
        padding=0,
    )
    grid.add_column("\n\n\nmethod")
    for which in MEASURED:
        for place, words in enumerate(HEADINGS.values()):
            grid.add_column(f"{which}:\n{words}" if place == 0 else f"\n{words}", justify="right")
    grid.add_row("expert", *ending_cells(summary["expert"]), end_section=True)
    for name, method in summary["methods"].items():
        measured = (method["overall"], method["rounds"][-1]["policy"], method["final"])
        cells = (cell for figures in measured for cell in ending_cells(figures))
        grid.add_row(name.replace("-", "-\n"), *cells)
    return grid


def ending_cells(figures: Mapping[str, Any]) -> list[str]:
    """Return a cell of a rate in per cent and its interval for each way to end, as in HEADINGS."""
    found = endings(figures)
    return [_cell(*found[word]) for word in HEADINGS]


def _cell(rate: float | None, interval: Any) -> str:
    if rate is None:
        return "–"
    low, high = interval
    return f"{100 * rate:.1f}\n[dim]{100 * low:.0f}–{100 * high:.0f}[/dim]"
