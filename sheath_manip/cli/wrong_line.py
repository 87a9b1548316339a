"""What is wrong with a line of options, in one sentence each instead of tyro's boxes."""

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from difflib import get_close_matches
from itertools import takewhile
from typing import Any

from sheath_manip.cli.examples import EXAMPLES
from sheath_manip.exceptions import ParameterError, UnknownNameError

KINDS = {"INT": ("a whole number", "20"), "FLOAT": ("a number", "0.05")}
"""by tyro's word for the kind of a value: what it is called here, and one such"""
OPTION = re.compile(r"--[a-z][a-z0-9.-]*[a-z0-9]")


def require_verb(argv: Sequence[str], verbs: Iterable[str]) -> None:
    """Raise UnknownNameError where the line's first word, or the second after it, is no verb."""
    verbs = list(verbs)
    if not argv or argv[0].startswith("-"):
        return
    if argv[0] not in verbs:
        raise UnknownNameError("verb", argv[0], verbs)
    nested = _nested(argv[0])
    if nested and len(argv) > 1 and not argv[1].startswith("-") and argv[1] not in nested:
        raise UnknownNameError(f"verb of {argv[0]}", argv[1], nested)


@contextmanager
def one_sentence(
    prog: str, argv: Sequence[str], help_of: Callable[[Sequence[str]], str]
) -> Iterator[None]:
    """Raise ParameterError for a line that tyro rejects, and print nothing.

    A tyro that tells nobody why it rejects a line prints what it always did, and exits.

    Args:
        prog: the program's name.
        argv: the line.
        help_of: the text of the help that a line without options asks for.
    """
    try:
        # Known of tyro 1.0.17; no promise of its makers, hence the way without.
        from tyro._errors import on_parse_error
    except ImportError:
        yield
        return
    words = list(takewhile(lambda word: not word.startswith("-"), argv))
    verb = words[: 2 if words and _nested(words[0]) else 1]

    def tell(event: Any) -> None:
        said = _sentence(event, argv, lambda: OPTION.findall(help_of(words)))
        if said:
            raise ParameterError(f"{said} (see {' '.join([prog, *verb, '--help'])})")

    with on_parse_error(tell):
        yield


def _nested(verb: str) -> list[str]:
    return [name.split()[1] for name in EXAMPLES if name.startswith(f"{verb} ")]


def _sentence(event: Any, argv: Sequence[str], options: Callable[[], list[str]]) -> str:
    """What `event` of tyro says; empty for a kind that is not known here."""
    match type(event).__name__:
        case "UnrecognizedArgs":
            return _unknown(event.tokens, options())
        case "MissingArgs" if event.unrecognized_tokens:
            return _unknown(event.unrecognized_tokens, options())
        case "MissingArgs":
            named = [each.arg.get_invocation_text()[1] for each in event.missing_arguments]
            return f"the line lacks {' and '.join(map(_plain, named))}"
        case "MissingSubcommand":
            return f"the line lacks one of {', '.join(event.subcommand_spec.parser_from_name)}"
        case "BadValue" if event.reason == "too_few_values":
            return f"{_name(event.argument)} came without a value; wanted {_kind(event.argument)}"
        case "InvalidChoice":
            wanted = ", ".join(event.choices)
            return f"{_name(event.argument)} is {event.value!r}; wanted one of {wanted}"
        case "InstantiationFailure" if event.argument is not None:
            given = _given(_name(event.argument), argv)
            return f"{_name(event.argument)} is {given}; wanted {_kind(event.argument)}"
    return ""


def _unknown(tokens: Sequence[str], options: Sequence[str]) -> str:
    """The first option that there is not, or else the first word that belongs to none."""
    unknown = [token.split("=")[0] for token in tokens if token.startswith("-")]
    if not unknown:
        return f"nothing takes the word {tokens[0]!r}; wanted options, such as --help"
    near = get_close_matches(unknown[0], options, n=1)
    return f"unknown option {unknown[0]}{f'; did you mean {near[0]}?' if near else ''}"


def _name(argument: Any) -> str:
    if argument.is_positional():
        return str(argument.lowered.metavar)
    return argument.lowered.name_or_flags[-1]


def _kind(argument: Any) -> str:
    metavar = _plain(argument.lowered.metavar)
    kind, such = KINDS.get(metavar.strip("[]").split(" ")[0], (metavar, ""))
    return f"{kind}, like {such}" if such else kind


def _given(name: str, argv: Sequence[str]) -> str:
    """The words after the option `name`, or after its sign of equality."""
    for place, word in enumerate(argv):
        if word == name:
            after = takewhile(lambda word: not word.startswith("--"), argv[place + 1 :])
            return repr(" ".join(after))
        if word.startswith(f"{name}="):
            return repr(word.removeprefix(f"{name}="))
    return "no such value"


def _plain(text: Any) -> str:
    return " ".join(str(text).split())
