"""The burdens of a run as a table: what it asked, in the same words for any expert."""

from collections.abc import Sequence

from rich.table import Table
from rich.text import Text

from sheath_manip.cli.session import Session
from sheath_manip.metrics import endings_line
from sheath_manip.rollout.asked import Asked, AskedInEpisode, asked_in_all


def print_asked(episodes: Sequence[AskedInEpisode], session: Session) -> None:
    """Print requests, turns, seconds and labels, each apart, and how the episodes ended."""
    table = Table(box=None, pad_edge=False, show_header=False)
    table.add_column()
    table.add_column(justify="right")
    for name, value in rows(asked_in_all(episodes)):
        table.add_row(name, value)
    session.out.print(table)
    session.out.print(Text(endings_line(each.outcome for each in episodes)))


def rows(asked: Asked) -> list[tuple[str, str]]:
    """Return each number by its name, as it is printed."""
    return [
        ("requests", str(asked.requests)),
        ("requests a minute", f"{asked.requests_a_minute:.3g}"),
        ("requests an episode", f"{asked.requests_an_episode:.3g}"),
        ("median turn, s", f"{asked.median_turn_s:.3g}"),
        ("seconds driven", f"{asked.driven_s:.1f}"),
        ("seconds waited", f"{asked.waited_s:.1f}"),
        ("labels", str(asked.labels)),
    ]
