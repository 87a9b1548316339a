"""What broke down in an episode, kept in its header as runs of steps: mostly there is nothing."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import groupby
from typing import Any

from sheath_manip.types import Breakdown, Episode


@dataclass(frozen=True)
class BrokenSteps:
    """A run of steps in each of which the same broke down."""

    start: int
    stop: int
    """after the last one"""
    broken: tuple[Breakdown, ...]
    """in each of them, in that order"""


def broken_from_json(content: Any) -> tuple[BrokenSteps, ...]:
    """Return what `dataclasses.asdict` gave of each; ValueError for anything else."""
    try:
        return tuple(_run(each["start"], each["stop"], each["broken"]) for each in content)
    except (KeyError, TypeError) as error:
        raise ValueError(f"wanted steps in which something broke down ({error})") from error


def _run(start: Any, stop: Any, broken: Any) -> BrokenSteps:
    if not (type(start) is int and type(stop) is int and 0 <= start < stop):
        raise ValueError("wanted the first step that broke down, and the one after the last")
    named = tuple(Breakdown(each["who"], each["what"]) for each in broken)
    if not all(isinstance(text, str) for each in named for text in (each.who, each.what)):
        raise ValueError("wanted who broke down, and how, as text")
    return BrokenSteps(start, stop, named)


def broken_steps(episode: Episode) -> tuple[BrokenSteps, ...]:
    """Return what broke down, step by step; at step T what cut the episode short."""
    rows = [step.decision.broken for step in episode.steps]
    rows.append(() if episode.cut_short_by is None else (episode.cut_short_by,))
    # What cut it short is a run of its own, also where the same broke down before it.
    last = len(rows) - 1
    runs = groupby(enumerate(rows), key=lambda row: (row[0] == last, row[1]))
    listed = []
    for (_, broken), run in runs:
        places = [place for place, _ in run]
        if broken:
            listed.append(BrokenSteps(places[0], places[-1] + 1, broken))
    return tuple(listed)


def broken_by_step(
    listed: Iterable[BrokenSteps], length: int
) -> Mapping[int, tuple[Breakdown, ...]]:
    """Return the inverse: by step, of an episode of so many; what is beyond it counts for none."""
    return {
        place: run.broken for run in listed for place in range(run.start, min(run.stop, length + 1))
    }
