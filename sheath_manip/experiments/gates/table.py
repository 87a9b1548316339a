"""The benchmark's table, in two halves that each fit 100 columns."""

from collections.abc import Mapping
from typing import Any

from rich import box
from rich.console import Group
from rich.table import Table
from rich.text import Text

from sheath_manip.experiments.endings import HEADINGS
from sheath_manip.metrics import endings

Rows = Mapping[str, Mapping[str, Any]]


def tables(summary: Mapping[str, Any]) -> Group:
    """Return every task's tables: what the gates notice, foresee, and do in the loop."""
    parts = []
    for task, found in summary["tasks"].items():
        ordered = by_costly_mistakes(found["rows"])
        parts += [_noticed(task, ordered), _saved(task, ordered, summary["plan"])]
    return Group(*parts)


def by_costly_mistakes(rows: Rows) -> Rows:
    """The best at 'the policy makes a costly mistake here' first, what has no score last."""
    return dict(sorted(rows.items(), key=lambda item: -(costly_auroc(item[1]) or 0.0)))


def costly_auroc(row: Mapping[str, Any]) -> float | None:
    """AUROC of 'the policy makes a costly mistake here'; None without a score."""
    return row["errs"]["costly"] if "errs" in row else None


def _noticed(task: str, rows: Rows) -> Table:
    scored = {name: row for name, row in rows.items() if "auroc" in row}
    displacements = next(iter(scored.values()))["auroc"] if scored else {}
    grid = _table(
        f"{task}: what the gates notice",
        "AUROC × 100 of new expert states against displaced ones, and on the states that the "
        "policy visits: costly mistakes, and all that the expert would have done otherwise · "
        "inside: share of new expert episodes at the gate's threshold",
    )
    for name in (*displacements, "costly", "differs", "inside\n%"):
        grid.add_column(name.replace(" ", "\n", 1), justify="right", max_width=8)
    for name, row in scored.items():
        errs = row["errs"]
        values = (*row["auroc"].values(), errs["costly"], errs["differs"], row["expert_inside"])
        grid.add_row(_name(name), *(_percent(value) for value in values))
    return grid


def _saved(task: str, rows: Rows, plan: Mapping[str, Any]) -> Table:
    share = f"{100 * plan['share']:.0f} %"
    grid = _table(
        f"{task}: what the gates foresee, and what they save at {share} expert share",
        f"foreseen: failures with an alarm in the {plan['window']} steps before, at "
        f"{100 * plan['alarm_rate']:.0f} % of failure-free windows disturbed; then both, and the "
        "lead, at the gate's own threshold · alone: the policy that learned under the gate",
    )
    for header in (
        "fore-\nseen\n%",
        "own:\nfore-\nseen %",
        "dis-\nturbed\n%",
        "lead\nsteps",
        HEADINGS["succeeded"],
        "failed\n%\n95 %",
        "stuck\n%",
        "switches",
        "queries",
        f"alone:\n{HEADINGS['succeeded']}",
        "\nfailed\nstuck %",
    ):
        grid.add_column(header, justify="right")
    for name, row in rows.items():
        grid.add_row(_name(name), *_foreseen(row.get("alarm")), *_in_loop(row["loop"]))
    return grid


def _foreseen(alarm: Mapping[str, Any] | None) -> tuple[str, ...]:
    if alarm is None:
        return ("–",) * 4
    own = alarm["at"]["step"]
    rates = (alarm["foreseen"], own["foreseen"]["value"], own["disturbed"]["value"])
    return *(_percent(rate) for rate in rates), _number(own["lead_steps"])


def _in_loop(loop: Mapping[str, Any] | None) -> tuple[str, ...]:
    """At the common share; of the policy or the expert alone at its own."""
    if loop is None:
        return ("–",) * 7
    at, only = loop["at_share"], loop["points"][0]
    ended = only["executed"] if at is None else at
    low, high = only["executed"]["ci95"]["failure_rate"] if at is None else at["ci95"]
    asked = only if at is None else at
    alone = {word: _percent(rate) for word, (rate, _) in endings(loop["final"]).items()}
    return (
        _percent(ended["success_rate"]),
        f"{_percent(ended['failure_rate'])}\n{100 * low:.0f}–{100 * high:.0f}",
        # What is left by rounding is less than none.
        _percent(max(0.0, 1 - ended["success_rate"] - ended["failure_rate"])),
        _number(asked["switches_per_episode"]),
        _number(asked["queries_per_episode"]),
        alone["succeeded"],
        f"{alone['failed']}\n{alone['stuck']}",
    )


def _table(title: str, caption: str) -> Table:
    grid = Table(
        title=title,
        caption=caption,
        title_justify="left",
        caption_justify="left",
        box=box.SIMPLE_HEAD,
        padding=0,
        width=100,
    )
    grid.add_column("gate", overflow="fold")
    return grid


def _name(name: str) -> Text:
    return Text(name.replace("/", "\n  "))


def _percent(value: float | None) -> str:
    return "–" if value is None else f"{100 * value:.1f}"


def _number(value: float | None) -> str:
    return "–" if value is None else f"{value:.1f}"
