"""Warnings about what was asked for: one line on the terminal, once a command."""

import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from sheath_manip.exceptions import GateWarning
from sheath_manip.printable import printable


@contextmanager
def warned_in_one_line() -> Iterator[None]:
    """Print the first warning about a gate as a line; those of later rounds say the same."""
    with warnings.catch_warnings():
        otherwise, told = warnings.showwarning, list[str]()

        def show(message: Any, category: type[Warning], *place: Any, **rest: Any) -> None:
            if not issubclass(category, GateWarning):
                otherwise(message, category, *place, **rest)
            elif not told:
                told.append(str(message))
                print(f"sheath: warning: {printable(told[0])}", file=sys.stderr)

        warnings.showwarning = show
        yield
