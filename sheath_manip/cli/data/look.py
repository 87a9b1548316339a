"""`sheath data list`, `show` and `check`."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from sheath_manip.cli.options import StoreAddress
from sheath_manip.cli.session import Session
from sheath_manip.printable import printable

if TYPE_CHECKING:
    from sheath_manip.types import TaskSpec


@dataclass(frozen=True)
class ListStore:
    """Show one line an episode, and what it weighs in MB; or a data card."""

    store: StoreAddress
    """directory of the episodes, or a URL such as s3://bucket/demos"""
    card: bool = False
    """print a data card in markdown instead, for the folder that is handed on"""
    licence: str = "not stated"
    """licence of the data, for the data card"""

    def run(self, session: Session) -> int:
        """Print the list; 1 where an episode cannot be read."""
        if not self.card:
            from sheath_manip.dataset.table import print_list

            return print_list(self.store, session.out)
        from sheath_manip.dataset.card import card
        from sheath_manip.dataset.locations import open_store

        reader = open_store(self.store)
        names = reader.names()
        task = reader.header(names[0]).info.task if names else ""
        # Not by rich, which would wrap the lines of the table.
        print(printable(card(reader, _spec(session, task), self.licence)), end="")
        return 0


@dataclass(frozen=True)
class ShowEpisode:
    """Show where one episode comes from, how it went, and its arrays."""

    store: StoreAddress
    """directory of the episodes, or a URL"""
    episode: str = "0"
    """name of the episode, or its place in `sheath data list`, from 0; -1 is the last"""

    def run(self, session: Session) -> int:
        """Print it."""
        from sheath_manip.dataset.show import print_show

        return print_show(self.store, self.episode, session.out)


@dataclass(frozen=True)
class CheckStore:
    """Decompress every episode and name what is damaged."""

    store: StoreAddress
    """directory of the episodes, or a URL"""

    def run(self, session: Session) -> int:
        """Print the faults; 1 where data is affected."""
        from sheath_manip.dataset.table import print_check

        return print_check(self.store, session.out)


def _spec(session: Session, task: str) -> "TaskSpec | None":
    """The task's own names of features and actions, where this installation knows the task."""
    tasks = session.tasks()
    if task not in tasks:
        return None
    environment = tasks[task].make()
    try:
        return environment.spec
    finally:
        environment.close()
