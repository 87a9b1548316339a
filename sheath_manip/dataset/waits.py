"""When a robot stood still and waited for a person, kept in the header: mostly there is nothing."""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from sheath_manip.dataset.fields import MOST_STEPS, Fields, number, rows_of, shown, whole
from sheath_manip.types import Episode


@dataclass(frozen=True)
class Wait:
    """A wait for a person, which took no step."""

    step: int
    """that it came before"""
    waited_s: float
    """more than 0"""


def waits_of(episode: Episode) -> tuple[Wait, ...]:
    """Return the waits in an episode, in their order."""
    waited_s = (float(step.decision.waited_s) for step in episode.steps)
    return tuple(Wait(step, each) for step, each in enumerate(waited_s) if 0 < each < math.inf)


def waits_between(waits: Iterable[Wait], start: int, stop: int) -> tuple[Wait, ...]:
    """Return those before the steps `start` .. `stop` (exclusive), counted from `start`."""
    return tuple(
        Wait(each.step - start, each.waited_s) for each in waits if start <= each.step < stop
    )


def waits_from_json(content: Any) -> tuple[Wait, ...]:
    """Return what `dataclasses.asdict` gave of each; raises ValueError for anything else."""
    return rows_of(_wait, MOST_STEPS)(content)


def _wait(content: Any) -> Wait:
    fields = Fields(content)
    found = Wait(
        fields.take("step", whole(0, MOST_STEPS)), fields.take("waited_s", _positive_number)
    )
    fields.require_empty()
    return found


def _positive_number(value: Any) -> float:
    seconds = number(value)
    if not (seconds > 0 and math.isfinite(seconds)):
        raise ValueError(f"wanted seconds above 0, found {shown(value)}")
    return seconds
