"""What the methods of an experiment asked of the expert, as one table: each burden apart."""

from collections.abc import Mapping
from typing import Any

from rich import box
from rich.table import Table

from sheath_manip.experiments.burdens import overall_burdens

COLUMNS = {
    "takeovers_an_episode": ("takeovers:\nan\nepisode", ".1f"),
    "takeovers_a_minute": ("\na\nminute", ".1f"),
    "median_takeover_s": ("\nseconds\neach", ".2f"),
    "driving_s_an_episode": ("driving:\ns an\nepisode", ".1f"),
    "expert_share": ("\nshare\n%", ".1f"),
    "labels_an_episode": ("labels:\nan\nepisode", ",.0f"),
    "queries": ("\na\nseed", ",.0f"),
}
"""by the number, its heading and how it is written; they fit into 80 columns"""


def burdens_table(summary: Mapping[str, Any]) -> Table:
    """Return the table of a summary; it fits a terminal of 80 columns."""
    grid = Table(
        title=f"{summary['experiment']}: what was asked of the expert, in all rounds",
        caption="minutes are those in which somebody drove · seconds each: the median takeover",
        title_justify="left",
        caption_justify="left",
        box=box.SIMPLE_HEAD,
        padding=0,
    )
    grid.add_column("\n\nmethod")
    for heading, _ in COLUMNS.values():
        grid.add_column(heading, justify="right")
    for name, method in summary["methods"].items():
        overall = method["overall"]
        share, burdens = (
            overall["expert_share"],
            overall_burdens(method, summary.get("control_rate_hz")),
        )
        numbers = {
            **burdens,
            "expert_share": None if share is None else 100 * share,
            "queries": overall["queries"],
        }
        cells = (_cell(numbers[each], form) for each, (_, form) in COLUMNS.items())
        grid.add_row(name.replace("-", "-\n"), *cells)
    return grid


def _cell(value: float | None, form: str) -> str:
    return "–" if value is None else format(value, form)
