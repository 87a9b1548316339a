"""Beginning anew without losing what was recorded."""

from pathlib import Path

from rich.text import Text

from sheath_manip.cli.session import Session


def move_aside(runs: Path, session: Session) -> None:
    """Rename `runs`, so that nothing recorded is lost."""
    if not runs.exists():
        return
    number = 1
    while (aside := runs.with_name(f"{runs.name}-before-{number}")).exists():
        number += 1
    runs.rename(aside)
    session.out.print(Text(f"the earlier run is kept in {aside}"))
