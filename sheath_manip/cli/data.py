"""`sheath data list` and `sheath data check`."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from sheath_manip.cli.session import Session

StorePath = Annotated[tyro.conf.Positional[Path], tyro.conf.arg(metavar="STORE")]


@dataclass(frozen=True)
class ListStore:
    """Show one line an episode, and what it weighs in MB."""

    store: StorePath
    """directory of the episodes"""

    def run(self, session: Session) -> int:
        """Print the list; 1 where an episode cannot be read."""
        from sheath_manip.dataset.table import print_list

        return print_list(self.store, session.out)


@dataclass(frozen=True)
class CheckStore:
    """Decompress every episode and name what is damaged."""

    store: StorePath
    """directory of the episodes"""

    def run(self, session: Session) -> int:
        """Print the faults; 1 where data is affected."""
        from sheath_manip.dataset.table import print_check

        return print_check(self.store, session.out)


@dataclass(frozen=True)
class Data:
    """Look into an episode store."""

    what: (
        Annotated[ListStore, tyro.conf.subcommand("list", prefix_name=False)]
        | Annotated[CheckStore, tyro.conf.subcommand("check", prefix_name=False)]
    )

    def run(self, session: Session) -> int:
        """Do what was asked for."""
        return self.what.run(session)
