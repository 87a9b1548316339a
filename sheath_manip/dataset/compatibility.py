"""Whether recordings fit each other and a task: the one check of all that mixes or reads them.

What differs in `differences` is refused. Variants of one task may be mixed where nothing else
differs, and what old recordings do not say is taken as it is; `remarks` names both.
"""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import zip_longest
from typing import Any

import numpy as np

from sheath_manip.dataset.header import Header
from sheath_manip.dataset.space import Space
from sheath_manip.exceptions import StoreError
from sheath_manip.types import TaskSpec

MOST_LISTED = 4
"""names and bounds that differ, in one line"""


@dataclass(frozen=True)
class RecordedSpec:
    """What must be alike in all that is learned from, shown or handed on together."""

    task: str
    control_rate_hz: float
    cameras: Mapping[str, tuple[int, int]]
    """(height, width) in pixels, by camera"""
    feature_size: int
    action_size: int
    space: Space | None
    """None where a recording does not say, which fits any"""

    @classmethod
    def of(cls, header: Header) -> "RecordedSpec":
        """Return what an episode's header says."""
        return cls(
            header.info.task,
            header.info.control_rate_hz,
            header.cameras,
            header.feature_size,
            header.action_size,
            header.space,
        )

    @classmethod
    def of_task(cls, spec: TaskSpec) -> "RecordedSpec":
        """Return what an episode of the task would say."""
        return cls(
            spec.name,
            spec.control_rate_hz,
            spec.cameras,
            len(spec.feature_names),
            len(spec.action.names),
            Space.of(spec),
        )


@dataclass(frozen=True)
class Difference:
    """One thing in which two specs differ."""

    what: str
    wanted: str
    got: str

    def __str__(self) -> str:
        return f"{self.what} {self.got} instead of {self.wanted}"


def differences(wanted: RecordedSpec, got: RecordedSpec) -> tuple[Difference, ...]:
    """Return all in which `got` is not as `wanted`; what either does not say is no difference."""
    rates = (f"{spec.control_rate_hz:.12g} Hz" for spec in (wanted, got))
    return (
        *_differing("task", wanted.task, got.task, repr(wanted.task), repr(got.task)),
        *_differing("control rate", wanted.control_rate_hz, got.control_rate_hz, *rates),
        *_of_cameras(wanted.cameras, got.cameras),
        *_differing("number of features", wanted.feature_size, got.feature_size),
        *_differing("number of actions", wanted.action_size, got.action_size),
        *_of_spaces(wanted.space, got.space),
    )


def require_compatible(
    wanted: RecordedSpec, got: RecordedSpec, who: str, wanted_by: str, remedy: str
) -> None:
    """Raise StoreError, in one line that names all `differences`, where there is one.

    `who` has the spec `got`, `wanted_by` the spec `wanted`; `remedy` says what would have worked.
    """
    found = differences(wanted, got)
    if found:
        listed = "; ".join(map(str, found))
        raise StoreError(f"{who} does not fit {wanted_by}: {listed}: {remedy}")


class Alike:
    """Holds recordings against each other as they come, whatever some of them leave unsaid."""

    def __init__(self, remedy: str) -> None:
        """Store what the error advises."""
        self._remedy = remedy
        self._fullest: RecordedSpec | None = None
        self._whose = ""

    def take(self, who: str, spec: RecordedSpec) -> None:
        """Raise StoreError where the recording `who` does not fit those before."""
        if self._fullest is not None:
            require_compatible(self._fullest, spec, who, self._whose, self._remedy)
        # One that says more serves better from here on: the others fit it, too.
        if self._fullest is None or (self._fullest.space is None and spec.space is not None):
            self._fullest, self._whose = spec, who


def remarks(episodes: Iterable[tuple[str, RecordedSpec]]) -> tuple[str, ...]:
    """Return what must be told of episodes that may be mixed all the same, a line each.

    Of each episode its variant and its spec are given.
    """
    variants, untold = Counter[str](), 0
    for variant, spec in episodes:
        variants[repr(variant) if variant else "an unknown one"] += 1
        untold += spec.space is None
    lines = []
    if len(variants) > 1:
        listed = ", ".join(f"{count} of {name}" for name, count in sorted(variants.items()))
        lines.append(f"episodes of several variants: {listed}")
    if untold:
        lines.append(
            f"{untold} of {variants.total()} episodes do not say what their features and actions "
            "mean, so only sizes, cameras and control rates were compared"
        )
    return tuple(lines)


def _of_cameras(
    wanted: Mapping[str, tuple[int, int]], got: Mapping[str, tuple[int, int]]
) -> Iterator[Difference]:
    if dict(wanted) != dict(got):
        yield Difference("cameras", _cameras(wanted), _cameras(got))


def _of_spaces(wanted: Space | None, got: Space | None) -> Iterator[Difference]:
    if wanted is None or got is None:
        return
    yield from _rows("features", wanted.feature_names, got.feature_names)
    yield from _rows("actions", wanted.action_names, got.action_names)
    yield from _rows("lower bounds", wanted.action_minimum, got.action_minimum)
    yield from _rows("upper bounds", wanted.action_maximum, got.action_maximum)
    yield from _rows("choices", wanted.action_choices or (), got.action_choices or ())


def _rows(what: str, wanted: tuple[Any, ...], got: tuple[Any, ...]) -> Iterator[Difference]:
    """Only those that differ, since there may be hundreds."""
    pairs = [pair for pair in zip_longest(wanted, got) if pair[0] != pair[1]]
    if pairs:
        yield Difference(what, *(_listed([_text(pair[side]) for pair in pairs]) for side in (0, 1)))


def _text(value: Any) -> str:
    """A name as Python writes it, since a file may hold any; a number as short as can be."""
    if isinstance(value, tuple):
        return f"({', '.join(map(_text, value))})"
    if isinstance(value, float):
        return str(np.float32(value))
    return "none" if value is None else repr(value)


def _differing(
    what: str, wanted: object, got: object, wanted_text: str = "", got_text: str = ""
) -> Iterator[Difference]:
    if wanted != got:
        yield Difference(what, wanted_text or str(wanted), got_text or str(got))


def _cameras(cameras: Mapping[str, tuple[int, int]]) -> str:
    listed = [f"{name} {height}x{width}" for name, (height, width) in cameras.items()]
    return _listed(listed) if listed else "none"


def _listed(words: list[str]) -> str:
    more = f" and {len(words) - MOST_LISTED} more" * (len(words) > MOST_LISTED)
    return ", ".join(words[:MOST_LISTED]) + more
