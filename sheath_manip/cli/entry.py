"""Runs a verb: parses the line, and turns every foreseen error into one line and an exit code."""

import inspect
import os
import shlex
import sys
from collections.abc import Mapping, Sequence
from contextlib import redirect_stdout, suppress
from dataclasses import make_dataclass
from io import StringIO
from typing import Annotated, Any, Union

import tyro

from sheath_manip.cli.claims import Claims
from sheath_manip.cli.collect import Collect
from sheath_manip.cli.data import Data
from sheath_manip.cli.evaluate import Evaluate
from sheath_manip.cli.examples import FIRST_STEPS, described
from sheath_manip.cli.experiment import Experiment
from sheath_manip.cli.figures import Figures
from sheath_manip.cli.gate import Gate
from sheath_manip.cli.interrupts import interruptible
from sheath_manip.cli.learn import Learn
from sheath_manip.cli.machine import Doctor, Tables
from sheath_manip.cli.planned import Planned, registry, verb_for
from sheath_manip.cli.replay import Replay
from sheath_manip.cli.run import Run
from sheath_manip.cli.session import LoadCatalog, Session, Verb
from sheath_manip.cli.teleop import Teleop
from sheath_manip.cli.train import Train
from sheath_manip.cli.warned import warned_in_one_line
from sheath_manip.cli.watch import Watch
from sheath_manip.cli.wrong_line import one_sentence, require_verb
from sheath_manip.exceptions import SheathError
from sheath_manip.printable import printable

OK, BAD_INPUT, INTERRUPTED, CUT_OFF = 0, 2, 130, 141

OF_A_TASK: dict[str, type[Verb]] = {
    "collect": Collect,
    "teleop": Teleop,
    "train": Train,
    "learn": Learn,
    "run": Run,
    "evaluate": Evaluate,
    "experiment": Experiment,
    "dashboard": Watch,
}
OF_A_STORE: dict[str, type[Verb]] = {
    "replay": Replay,
    "data": Data,
}
OF_A_POLICY: dict[str, type[Verb]] = {
    "gate": Gate,
}
OF_THE_MACHINE: dict[str, type[Verb]] = {
    "tasks": Tables,
    "claims": Claims,
    "figures": Figures,
    "doctor": Doctor,
}
VERBS = OF_THE_MACHINE | OF_A_TASK | OF_A_POLICY | OF_A_STORE
"""all of `sheath`"""


def run_command(catalog: LoadCatalog, argv: Sequence[str]) -> int:
    """Run `sheath` with `argv`, or say what to do first where it is empty; return its exit code."""
    if not argv:
        print(FIRST_STEPS, end="")
        return OK
    about = "Robots that learn from an expert without first having to fail."
    return _run(VERBS, catalog, argv, "sheath", about)


def run_task_command(catalog: LoadCatalog, task: str, argv: Sequence[str]) -> int:
    """Run the verbs for one task, which the line does not name; return the exit code."""
    bound = {name: _bound(verb, task) for name, verb in OF_A_TASK.items()}
    about = f"The task {task!r}, as `sheath` runs it."
    prog = f"python -m sheath_manip.tasks.{task.replace('-', '_')}"
    return _run(bound | OF_A_STORE, catalog, argv, prog, about)


def _run(
    verbs: Mapping[str, type[Verb]],
    catalog: LoadCatalog,
    argv: Sequence[str],
    prog: str,
    about: str,
) -> int:
    with interruptible() as interruption, warned_in_one_line():
        try:
            return _called(verbs, catalog, argv, prog, about)
        except Exception:
            if not interruption.came:
                raise
            return _interrupted()


def _interrupted() -> int:
    print("sheath: interrupted; what was recorded is kept", file=sys.stderr)
    return INTERRUPTED


def _called(
    verbs: Mapping[str, type[Verb]],
    catalog: LoadCatalog,
    argv: Sequence[str],
    prog: str,
    about: str,
) -> int:
    try:
        verb = read_line(verbs, catalog, argv, prog, about)
        return verb.run(Session(catalog, f"{prog} {shlex.join(argv)}".strip()))
    except BrokenPipeError:
        # Who reads has seen enough, as `head` has; what is left in the buffer goes nowhere.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return CUT_OFF
    except (SheathError, OSError) as error:
        print(f"sheath: {printable(' '.join(str(error).split()))}", file=sys.stderr)
        return BAD_INPUT
    except MemoryError:
        # No word of how much: the error seldom says.
        line = "out of memory; take shorter or fewer episodes, what was recorded is kept"
        print(f"sheath: {line}", file=sys.stderr)
        return BAD_INPUT
    except KeyboardInterrupt:
        return _interrupted()


def read_line(
    verbs: Mapping[str, type[Verb]],
    catalog: LoadCatalog,
    argv: Sequence[str],
    prog: str = "sheath",
    about: str = "",
) -> Verb:
    """Return the verb that `argv` asks for, with its options, and run nothing.

    Prints and raises SystemExit where the line wants a help. Raises UnknownNameError for a verb
    that there is not, and ParameterError where the line is no line of its verb.
    """
    require_verb(argv, verbs)

    def help_of(words: Sequence[str]) -> str:
        with redirect_stdout(StringIO()) as printed, suppress(SystemExit):
            _parsed(verbs, catalog, [*words, "--help"], prog, about)
        return printed.getvalue()

    with one_sentence(prog, argv, help_of):
        return _parsed(verbs, catalog, argv, prog, about)


def _parsed(
    verbs: Mapping[str, type[Verb]],
    catalog: LoadCatalog,
    argv: Sequence[str],
    prog: str,
    about: str,
) -> Verb:
    choices = [_choice(name, verb, catalog, argv) for name, verb in verbs.items()]
    line: Any = Union[tuple(choices)]  # noqa: UP007 - of a list that is known only here
    return tyro.cli(
        line,
        args=list(argv),
        prog=prog,
        description=about,
        config=(tyro.conf.FlagCreatePairsOff,),
        registry=registry,
    )


def _choice(name: str, verb: type[Verb], catalog: LoadCatalog, argv: Sequence[str]) -> Any:
    """What tyro is told of a verb; its defaults follow the line where the line is of this verb."""
    words = inspect.getdoc(verb) or ""
    if list(argv[:1]) != [name]:
        # In the list of all verbs a sentence each is enough.
        brief = " ".join(words.split("\n\n")[0].split())
        return Annotated[verb, _subcommand(name, description=brief)]
    options: dict[str, Any] = {"description": described(name, words)}
    if issubclass(verb, Planned):
        verb, before = verb_for(verb, catalog, argv[1:])
        if before is not None:
            options["default"] = before
    return Annotated[verb, _subcommand(name, **options)]


def _subcommand(name: str, **options: Any) -> Any:
    return tyro.conf.subcommand(name, prefix_name=False, **options)


def _bound(verb: type[Verb], task: str) -> type[Verb]:
    """`verb` for `task` alone: the same options without the task's name."""
    hidden = tyro.conf.Suppress[tyro.conf.Fixed[str]]
    return make_dataclass(
        verb.__name__,
        [("task", hidden, task)],
        bases=(verb,),
        namespace={"__doc__": verb.__doc__},
        frozen=True,
        kw_only=True,
    )
