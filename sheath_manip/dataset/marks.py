"""What a person said of an episode afterwards: a small file beside it, the episode itself stays."""

import json
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sheath_manip.dataset.digests import DIGEST, stamped, unstamped
from sheath_manip.dataset.faults import Fault, FaultKind
from sheath_manip.dataset.fields import MOST_STEPS, Fields, one_of, rows_of, shown, whole, word
from sheath_manip.dataset.naming import is_episode_name
from sheath_manip.dataset.rooted_files import entries_now, kind_of, read_inside
from sheath_manip.exceptions import ParameterError, StoreError
from sheath_manip.files.bounded_json import parse_json
from sheath_manip.files.outputs import sync, written_aside
from sheath_manip.printable import printable
from sheath_manip.types import Episode, Outcome, Step

SUFFIX = ".marks.json"
FORMAT = "sheath-marks"
SCHEMA = 1
MOST_MARKS_BYTES = 4 << 20
LONGEST_NOTE = 200
"""letters"""
_STEP = whole(0, MOST_STEPS)
_OUTCOME = one_of(Outcome)


@dataclass(frozen=True, order=True)
class Note:
    """What a person said of one step."""

    step: int
    text: str
    """one line, not empty"""


@dataclass(frozen=True)
class Marks:
    """A person's marks of an episode; by default nothing was said."""

    outcome: Outcome | None = None
    """how the episode ended in truth; None: as recorded"""
    bad: tuple[tuple[int, int], ...] = ()
    """stretches not to learn from, as (first step, first step after): sorted and apart"""
    notes: tuple[Note, ...] = ()
    """sorted by step, at most one of each"""

    def is_bad(self, length: int) -> NDArray[np.bool_]:
        """(length,) which steps are not to be learned from."""
        bad = np.zeros(length, bool)
        for start, stop in self.bad:
            bad[start:stop] = True
        return bad

    def bad_steps(self, length: int) -> int:
        """Return how many of `length` steps are not to be learned from, whatever headers claim."""
        return sum(min(stop, length) - min(start, length) for start, stop in self.bad)

    def with_note(self, step: int, text: str) -> "Marks":
        """Return these marks with `text` said of `step`, in place of what was; empty for nothing.

        Raises ParameterError for a step below 0 and a text that is longer than `LONGEST_NOTE`.
        """
        text = " ".join(printable(text).split())
        if step < 0 or len(text) > LONGEST_NOTE:
            raise ParameterError(
                f"the note has {len(text)} letters, at step {step}; wanted at most {LONGEST_NOTE}, "
                "at a step from 0"
            )
        others = [each for each in self.notes if each.step != step]
        return replace(self, notes=tuple(sorted([*others, *([Note(step, text)] * bool(text))])))

    def with_bad(self, start: int, stop: int) -> "Marks":
        """Return these marks with one more bad stretch; raises ParameterError for an empty one."""
        if not 0 <= start < stop:
            raise ParameterError(
                f"the bad stretch is {start} .. {stop}; wanted a first step of at least 0 and a "
                "stop after it"
            )
        merged: list[tuple[int, int]] = []
        for each in sorted((*self.bad, (start, stop))):
            if merged and each[0] <= merged[-1][1]:
                merged[-1] = merged[-1][0], max(merged[-1][1], each[1])
            else:
                merged.append(each)
        return replace(self, bad=tuple(merged))


def learnable(episode: Episode, marks: Marks) -> Episode:
    """`episode` with no label where it is marked bad."""
    if not marks.bad:
        return episode
    bad = marks.is_bad(len(episode))
    steps = (
        _unlabelled(step) if is_bad else step
        for step, is_bad in zip(episode.steps, bad, strict=True)
    )
    return replace(episode, steps=tuple(steps))


def marks_path(store: Path, name: str) -> Path:
    """Return where the marks of the episode `name` are kept."""
    return store / f"{name}{SUFFIX}"


def is_marks_name(entry: str) -> bool:
    """Return whether `entry` is the name of a file of marks."""
    return entry.endswith(SUFFIX) and is_episode_name(entry.removesuffix(SUFFIX))


def marked_name(entry: str) -> str:
    """Return the name of the episode that a file of marks is of."""
    return entry.removesuffix(SUFFIX)


def read_marks(store: Path, name: str) -> Marks:
    """The marks of an episode, empty where there are none; raises StoreError where broken."""
    path = marks_path(store, name)
    try:
        content = read_inside(store, path.name, MOST_MARKS_BYTES)
    except FileNotFoundError:
        return Marks()
    except OSError as error:
        raise StoreError(f"cannot read {path} ({error})") from error
    return parse_marks(path, content)


def parse_marks(where: Path | str, content: bytes) -> Marks:
    """The marks in `content`; raises StoreError, told of `where`, where they are none."""
    try:
        told = parse_json(content)
        # Marks of before there was one have no digest.
        fields = Fields(unstamped(told) if isinstance(told, dict) and DIGEST in told else told)
        schema = fields.take("format", word), fields.take("schema", whole(0, 1 << 30))
        if schema != (FORMAT, SCHEMA):
            raise ValueError(f"format {schema[0]!r}, schema {schema[1]}")
        outcome = fields.take("outcome", lambda told: None if told is None else _OUTCOME(told))
        stretches = fields.take("bad", rows_of(rows_of(_STEP, 2), MOST_STEPS))
        notes = fields.take("notes", rows_of(_note, MOST_STEPS), absent=())
        fields.require_empty()
        if any(one.step >= next.step for one, next in pairwise(notes)):
            raise ValueError("wanted notes in order, one of a step")
        bad, last = [], -1
        for stretch in stretches:
            if len(stretch) != 2 or not last < stretch[0] < stretch[1]:
                raise ValueError("wanted stretches in order and apart, none of them empty")
            bad.append(stretch)
            last = stretch[1]
        return Marks(outcome, tuple(bad), notes)
    except ValueError as error:
        raise StoreError(
            f"{where} holds no marks of schema {SCHEMA} ({error}); delete it, and mark the "
            "episode again"
        ) from error


def write_marks(store: Path, name: str, marks: Marks) -> None:
    """Put `marks` in the place of those before, all at once; none are none. Raises OSError."""
    path = marks_path(store, name)
    if marks == Marks():
        path.unlink(missing_ok=True)
        sync(store)
    else:
        with written_aside(path) as aside:
            aside.write_text(marks_text(marks))


def marks_text(marks: Marks) -> str:
    """Return the marks as their file holds them."""
    fields = {"format": FORMAT, "schema": SCHEMA, "outcome": marks.outcome, "bad": marks.bad}
    if marks.notes:
        # What few have is written for those alone: older versions read the rest.
        fields["notes"] = [[each.step, each.text] for each in marks.notes]
    return json.dumps(stamped(fields))


def marks_faults(store: Path, names: set[str]) -> list[Fault]:
    """Return what is wrong with the files of marks in `store`, which has the episodes `names`."""
    faults = []
    for entry, status in entries_now(store):
        # What is no plain file has been told of.
        if not is_marks_name(entry.name) or kind_of(status):
            continue
        name = entry.name.removesuffix(SUFFIX)
        if name not in names:
            text = "marks of an episode that is not here; delete it"
            faults.append(Fault(entry.name, FaultKind.FOREIGN, text))
            continue
        try:
            read_marks(store, name)
        except StoreError as error:
            faults.append(Fault(entry.name, FaultKind.UNREADABLE, str(error)))
    return faults


def _note(value: Any) -> Note:
    if not isinstance(value, list) or len(value) != 2:
        raise ValueError(f"wanted a step and a text, found {shown(value)}")
    step, text = _STEP(value[0]), word(value[1])
    if not text or not text.isprintable() or len(text) > LONGEST_NOTE:
        raise ValueError(f"wanted a line of at most {LONGEST_NOTE} letters, found {shown(text)}")
    return Note(step, text)


def _unlabelled(step: Step) -> Step:
    return replace(step, labelled=None, decision=replace(step.decision, query=False))
