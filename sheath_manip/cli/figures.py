"""`sheath figures`: the figures of results that are there already."""

from dataclasses import dataclass
from pathlib import Path

from rich.text import Text

from sheath_manip.cli.session import Session


@dataclass(frozen=True, kw_only=True)
class Figures:
    """Draw the figures of committed results again, as far as their summaries alone give them."""

    results: Path = Path("results")
    """directory of the experiments' results"""

    def run(self, session: Session) -> int:
        """Draw all, and print a line for each."""
        # Only now: other verbs need no matplotlib.
        from sheath_manip.experiments.figures.redrawing import redraw

        for path in redraw(self.results):
            session.out.print(Text(str(path)))
        return 0
