"""How an episode of a gymnasium environment stands: by what its info says, or by a function."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from sheath_manip.types import Outcome

SUCCESS_KEYS = ("is_success", "success")


@dataclass(frozen=True, eq=False)
class Moment:
    """What an environment answered to one action, as gymnasium has it."""

    observation: Any
    reward: float = 0.0
    terminated: bool = False
    truncated: bool = False
    info: Mapping[str, Any] = field(default_factory=dict)


Judging = Callable[[Moment], Outcome]
"""TIME_LIMIT as long as nothing is decided"""


def by_info(moment: Moment) -> Outcome:
    """Judge by the info's `is_success` or `success`; an end of the task without it is a failure."""
    for key in SUCCESS_KEYS:
        if bool(moment.info.get(key, False)):
            return Outcome.SUCCESS
    return Outcome.FAILURE if moment.terminated else Outcome.TIME_LIMIT
