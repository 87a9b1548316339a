"""What broke down in an episode, kept in its header as runs of steps: mostly there is nothing."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import groupby
from typing import Any

from sheath_manip.dataset.fields import MOST_STEPS, Fields, rows_of, whole, word
from sheath_manip.types import Breakdown, Episode

_MOST_AT_ONCE = 64


@dataclass(frozen=True)
class BrokenSteps:
    """A run of steps in each of which the same broke down."""

    start: int
    stop: int
    """after the last one"""
    broken: tuple[Breakdown, ...]
    """in each of them, in that order"""


def broken_from_json(content: Any) -> tuple[BrokenSteps, ...]:
    """Return what `dataclasses.asdict` gave of each; raises ValueError for anything else."""
    return rows_of(_run, MOST_STEPS + 1)(content)


def _run(content: Any) -> BrokenSteps:
    fields = Fields(content)
    start = fields.take("start", whole(0, MOST_STEPS))
    stop = fields.take("stop", whole(start + 1, MOST_STEPS + 1))
    broken = fields.take("broken", rows_of(_breakdown, _MOST_AT_ONCE))
    fields.require_empty()
    return BrokenSteps(start, stop, broken)


def _breakdown(content: Any) -> Breakdown:
    fields = Fields(content)
    found = Breakdown(fields.take("who", word), fields.take("what", word))
    fields.require_empty()
    return found


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


def broken_between(listed: Iterable[BrokenSteps], start: int, stop: int) -> tuple[BrokenSteps, ...]:
    """Return what broke down in the steps `start` .. `stop` (exclusive), counted from `start`."""
    cut = (
        BrokenSteps(max(run.start, start) - start, min(run.stop, stop) - start, run.broken)
        for run in listed
    )
    return tuple(run for run in cut if run.start < run.stop)


def broken_by_step(
    listed: Iterable[BrokenSteps], length: int
) -> Mapping[int, tuple[Breakdown, ...]]:
    """Return the inverse: by step, of an episode of so many; what is beyond it counts for none."""
    return {
        place: run.broken for run in listed for place in range(run.start, min(run.stop, length + 1))
    }
