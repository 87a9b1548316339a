"""What every verb is given: the tasks, the terminal, and how it was called."""

import os
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Protocol

from rich.console import Console
from rich.panel import Panel
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn
from rich.text import Text

from sheath_manip.cli.own_tasks import is_reference, referenced
from sheath_manip.cli.plain_console import PlainConsole
from sheath_manip.exceptions import ParameterError, UnknownNameError
from sheath_manip.experiments.progress import told_headway
from sheath_manip.experiments.study import Study
from sheath_manip.learning.headway import HeadwayCount, left_words
from sheath_manip.protocols import Listener
from sheath_manip.registry import working
from sheath_manip.task import Task
from sheath_manip.types.work import Headway


@dataclass(frozen=True)
class Catalog:
    """The tasks and the studies that there are, each by the task's name."""

    tasks: Mapping[str, Task]
    studies: Mapping[str, Study]


LoadCatalog = Callable[[], Catalog]
"""called only by verbs that need a task, since tasks bring their simulator"""

OWN_TASK = "a task of your own is given as file.py:TASK: docs/own/task.md"
PIPED_COLUMNS = 160


@dataclass(frozen=True)
class Session:
    """One call of the command."""

    catalog: LoadCatalog
    command: str
    """as it was typed"""
    out: Console = field(default_factory=lambda: PlainConsole(width=_width()))
    """for results"""
    err: Console = field(default_factory=lambda: PlainConsole(stderr=True))
    """for progress, so that results can be piped"""

    def task(self, name: str) -> Task:
        """Return the task of that name, or the one that `file.py:TASK` says.

        Raises UnknownNameError, and RegistrationError where a file cannot be used.
        """
        if is_reference(name):
            return self.study(name).task
        tasks = self.catalog().tasks
        if name not in tasks:
            raise UnknownNameError("task", name, tasks, OWN_TASK)
        return tasks[name]

    def runnable(self, name: str) -> Task:
        """Return the task, of which episodes are to be run; raises SetupError where none can."""
        task = self.task(name)
        if task.require is not None:
            task.require()
        return task

    def study(self, name: str) -> Study:
        """Return the study of the task, a bare one where it has none; raises as `task` does."""
        if is_reference(name):
            found = referenced(name)
            return found if isinstance(found, Study) else Study(found)
        task, studies = self.task(name), self.catalog().studies
        return studies[name] if name in studies else Study(task)

    def tasks(self) -> list[Task]:
        """Return all tasks but those that cannot be imported, of which a line is printed each."""
        return list(working(self.catalog().tasks, self.complain).values())

    def studies(self) -> list[Study]:
        """Return all studies, as `tasks` does."""
        return list(working(self.catalog().studies, self.complain).values())

    def complain(self, line: str) -> None:
        """Print a line about what is left out."""
        self.err.print(Text(line, "yellow"))

    def remark(self, line: str) -> None:
        """Print what must be told beside the results; nothing for an empty line."""
        if line:
            self.err.print(Text(line))

    def announce(self, address: str) -> None:
        """Print the address of a page, token included."""
        text = Text(address, no_wrap=True, style="bold cyan")
        self.out.print(Panel.fit(text, title="open in a browser", padding=(1, 2)))

    @contextmanager
    def progress(
        self,
        what: str,
        total: int,
        took_s: Callable[[], float] | None = None,
        listeners: Sequence[Listener] = (),
    ) -> Iterator[Callable[[str], None]]:
        """A bar of `total` units; call what it yields, with a word on the unit, after each.

        `took_s` gives the time so far where earlier sessions count as well; `listeners` that want
        to know how far it is are told.
        """
        columns = (
            TextColumn("{task.description}"),
            BarColumn(),
            MofNCompleteColumn(),
            TextColumn("{task.fields[left]}"),
        )
        counted, tell = HeadwayCount(total, took_s), told_headway(listeners)
        with Progress(
            *columns, console=self.err, transient=True, disable=not self.err.is_terminal
        ) as bar:
            line = bar.add_task(what, total=total, left="")

            def report(word: str) -> None:
                headway = counted.count()
                left = left_words(headway)
                bar.update(line, completed=headway.done, description=f"{what}: {word}", left=left)
                tell(headway)

            yield report
            tell(Headway(total, total))


def _width() -> int | None:
    """Columns for results: the terminal's, and enough for whole lines where they are piped."""
    return None if sys.stdout.isatty() or "COLUMNS" in os.environ else PIPED_COLUMNS


class Verb(Protocol):
    """One verb of the command: its fields are its options, `run` does it."""

    def run(self, session: Session) -> int:
        """Do it; return the exit code."""
        ...


def at_least_one(name: str, value: int) -> int:
    """`value`; raises ParameterError where it is below 1."""
    if value < 1:
        raise ParameterError(f"{name} is {value}; wanted at least 1")
    return value
