"""The page of the command line: what each verb's `--help` prints, which follows from its types."""

import os
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stdout, suppress
from io import StringIO

from sheath_manip.cli.entry import OF_A_TASK, OF_THE_MACHINE, run_command
from sheath_manip.cli.examples import EXAMPLES
from sheath_manip.cli.session import Catalog

COLUMNS = "96"
HEAD = """# Command line

**For** everyone who types `sheath`: every verb with all its options and their defaults.

`sheath VERB --help` prints the same. The verbs `train`, `learn` and `experiment` take their
defaults from the plan of a task: with the task's name before it, as in `sheath train driving
--help`, the help prints those values. Bad input is one line and exit code 2, Ctrl-C exit code
130; what was recorded until then is kept. Where Ctrl-C is the regular end, of `sheath replay`,
`sheath dashboard` and a page that `--hold` keeps open, the exit code is 0.

`python -m tasks.driving` is the same command for one task, whose name is then left out; from an
installed wheel it is `python -m sheath_manip.tasks.driving`.
"""
GROUPS = {
    "Look around": tuple(OF_THE_MACHINE),
    "Drive, record, learn": tuple(OF_A_TASK),
    "A gate for a policy from elsewhere": ("gate fit", "gate show"),
    "Episodes that are recorded": (
        "replay",
        *(verb for verb in EXAMPLES if verb.startswith("data ")),
    ),
}


def command_line() -> str:
    """Return the whole page."""
    parts = [HEAD]
    for heading, verbs in GROUPS.items():
        parts.append(f"## {heading}\n")
        parts += [f"### sheath {verb}\n\n```text\n{help_of(verb)}```\n" for verb in verbs]
    return "\n".join(parts)


def help_of(verb: str) -> str:
    """Return what `sheath VERB --help` prints on a terminal of 96 columns."""
    printed = StringIO()
    # tyro ends the process once it has printed the help.
    with _columns(COLUMNS), redirect_stdout(printed), suppress(SystemExit):
        run_command(_no_catalog, [*verb.split(), "--help"])
    return "\n".join(line.rstrip() for line in printed.getvalue().strip().splitlines()) + "\n"


def _no_catalog() -> Catalog:
    raise AssertionError("a help that names no task loads none")


@contextmanager
def _columns(columns: str) -> Iterator[None]:
    before = os.environ.get("COLUMNS")
    os.environ["COLUMNS"] = columns
    try:
        yield
    finally:
        del os.environ["COLUMNS"]
        if before is not None:
            os.environ["COLUMNS"] = before
