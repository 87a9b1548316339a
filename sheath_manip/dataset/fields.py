"""Values out of JSON that anybody may have written, each held against what it must be."""

import math
from collections.abc import Callable, Mapping
from typing import Any

MOST_STEPS = 10**8
"""of an episode"""
MOST_CHARACTERS = 4096
"""of a word: no name that is told or printed is longer"""
_SHOWN = 60
"""characters of a wrong value that an error shows"""

Read = Callable[[Any], Any]
"""Gives a value as Python has it; raises ValueError for what it must not be."""


class Fields:
    """The fields of a JSON object, each taken once; at the end none may be left."""

    def __init__(self, fields: Any) -> None:
        """Store them; raises ValueError where `fields` is no object."""
        if not isinstance(fields, Mapping):
            raise ValueError(f"wanted fields, found {shown(fields)}")
        self._left = dict(fields)

    def take(self, name: str, read: Read, absent: Any = ...) -> Any:
        """Return the field as `read` gives it, or `absent` where that is given and there is none.

        Raises ValueError, which names the field.
        """
        if name not in self._left:
            if absent is not ...:
                return absent
            raise ValueError(f"it has no field {name!r}")
        try:
            return read(self._left.pop(name))
        except ValueError as error:
            raise ValueError(f"{name}: {error}") from error

    def require_empty(self) -> None:
        """Raise ValueError where a field is left, which nobody here knows."""
        for name in self._left:
            raise ValueError(f"unknown field {shown(name)}")


def word(value: Any) -> str:
    """Return a text."""
    if not isinstance(value, str) or len(value) > MOST_CHARACTERS:
        raise ValueError(
            f"wanted a text of at most {MOST_CHARACTERS} letters, found {shown(value)}"
        )
    # As a lone surrogate, which no terminal and no file takes.
    if not value.isascii() and any("\ud800" <= letter <= "\udfff" for letter in value):
        raise ValueError(f"wanted letters, found {shown(value)}")
    return value


def whole(least: int, most: int) -> Read:
    """Return what reads a whole number from `least` to `most`."""

    def read(value: Any) -> int:
        if type(value) is not int or not least <= value <= most:
            raise ValueError(f"wanted a whole number {least} .. {most}, found {shown(value)}")
        return value

    return read


def number(value: Any) -> float:
    """Return a float: a number, or one of the names that `strict_float` gives to what is none."""
    if type(value) is int or (type(value) is float and math.isfinite(value)):
        try:
            return float(value)
        except OverflowError:
            pass
    elif value in ("NaN", "Infinity", "-Infinity"):
        return float(value)
    raise ValueError(f"wanted a number, found {shown(value)}")


def flag(value: Any) -> bool:
    """Return true or false."""
    if not isinstance(value, bool):
        raise ValueError(f"wanted true or false, found {shown(value)}")
    return value


def one_of(kind: Callable[[str], Any]) -> Read:
    """Return what reads a member of an enumeration of words."""

    def read(value: Any) -> Any:
        try:
            return kind(word(value))
        except ValueError:
            raise ValueError(f"{shown(value)} is unknown here") from None

    return read


def rows_of(read: Read, most: int) -> Read:
    """Return what reads a list of at most so many values."""

    def read_all(value: Any) -> tuple[Any, ...]:
        if not isinstance(value, list | tuple) or len(value) > most:
            raise ValueError(f"wanted a list of at most {most}, found {shown(value)}")
        return tuple(map(read, value))

    return read_all


def named(read: Read, most: int) -> Read:
    """Return what reads an object of at most so many values, whose names may be any text."""

    def read_all(value: Any) -> dict[str, Any]:
        if not isinstance(value, Mapping) or len(value) > most:
            raise ValueError(f"wanted at most {most} names with values, found {shown(value)}")
        return {word(name): read(each) for name, each in value.items()}

    return read_all


def shown(value: Any) -> str:
    """Return a value as an error shows it, in few letters."""
    text = repr(value)
    return text if len(text) <= _SHOWN else f"{text[:_SHOWN]}…"
