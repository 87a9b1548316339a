"""What broke down in an episode, kept in its header as runs of steps: mostly there is nothing."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Self

from sheath_manip.types import Breakdown, Episode


@dataclass(frozen=True)
class BrokenSteps:
    """One kind of breakdown, over a run of steps."""

    who: str
    what: str
    start: int
    stop: int
    """after the last one"""

    @classmethod
    def from_json(cls, content: Any) -> Self:
        """Return what `dataclasses.asdict` gave; ValueError, TypeError or KeyError for others."""
        who, what = content["who"], content["what"]
        start, stop = content["start"], content["stop"]
        if not (isinstance(who, str) and isinstance(what, str)):
            raise TypeError("wanted who broke down, and how, as text")
        if not (type(start) is int and type(stop) is int and 0 <= start < stop):
            raise ValueError(f"wanted steps that something broke down in, found {start} .. {stop}")
        return cls(who, what, start, stop)


def broken_steps(episode: Episode) -> tuple[BrokenSteps, ...]:
    """Return what broke down, in the order of the first steps; at step T what cut it short."""
    rows = [step.decision.broken for step in episode.steps]
    rows.append(() if episode.cut_short_by is None else (episode.cut_short_by,))
    found: dict[Breakdown, list[list[int]]] = {}
    for place, row in enumerate(rows):
        for each in row:
            runs = found.setdefault(each, [])
            if runs and runs[-1][1] == place:
                runs[-1][1] = place + 1
            elif not runs or runs[-1][1] < place:
                runs.append([place, place + 1])
    listed = [
        BrokenSteps(each.who, each.what, start, stop)
        for each, runs in found.items()
        for start, stop in runs
    ]
    return tuple(sorted(listed, key=lambda run: run.start))


def broken_by_step(
    listed: Iterable[BrokenSteps], length: int
) -> Mapping[int, tuple[Breakdown, ...]]:
    """Return the inverse: by step, of an episode of so many; what is beyond it counts for none."""
    by_step: dict[int, tuple[Breakdown, ...]] = {}
    for run in listed:
        for place in range(run.start, min(run.stop, length + 1)):
            by_step[place] = (*by_step.get(place, ()), Breakdown(run.who, run.what))
    return by_step
