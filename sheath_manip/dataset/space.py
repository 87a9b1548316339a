"""What the numbers of an episode mean: names of features and actions, and the actions' bounds."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from numpy.typing import NDArray

from sheath_manip.json_files import strict_float
from sheath_manip.types import TaskSpec


@dataclass(frozen=True)
class Space:
    """The part of a `TaskSpec` that no array of an episode tells, as plain numbers and words."""

    feature_names: tuple[str, ...]
    action_names: tuple[str, ...]
    action_minimum: tuple[float, ...]
    action_maximum: tuple[float, ...]
    action_choices: tuple[tuple[float, ...], ...] | None
    """the admissible actions; None where all within the bounds are"""

    @classmethod
    def of(cls, spec: TaskSpec) -> "Space":
        """Return the space of a task."""
        action = spec.action
        choices = None if action.choices is None else tuple(map(_plain, action.choices))
        return cls(
            tuple(spec.feature_names),
            tuple(action.names),
            _plain(action.minimum),
            _plain(action.maximum),
            choices,
        )

    def to_json(self) -> dict[str, Any]:
        """Return it as strict JSON; `from_json` is the inverse."""
        choices = self.action_choices
        return {
            "feature_names": list(self.feature_names),
            "action_names": list(self.action_names),
            "action_minimum": list(map(strict_float, self.action_minimum)),
            "action_maximum": list(map(strict_float, self.action_maximum)),
            "action_choices": choices and [list(map(strict_float, each)) for each in choices],
        }

    @classmethod
    def from_json(cls, fields: Mapping[str, Any]) -> "Space":
        """Return what `to_json` gave; raises KeyError, TypeError or ValueError for anything else.

        The lists must agree in length.
        """
        choices = fields["action_choices"]
        space = cls(
            _words(fields["feature_names"]),
            _words(fields["action_names"]),
            _numbers(fields["action_minimum"]),
            _numbers(fields["action_maximum"]),
            None if choices is None else tuple(map(_numbers, choices)),
        )
        size = len(space.action_names)
        rows = (space.action_minimum, space.action_maximum, *(space.action_choices or ()))
        if any(len(row) != size for row in rows):
            raise ValueError(f"wanted bounds and choices of {size} numbers, as there are actions")
        return space


def _plain(values: NDArray) -> tuple[float, ...]:
    return tuple(float(value) for value in values)


def _words(values: Any) -> tuple[str, ...]:
    if not isinstance(values, list) or not all(isinstance(value, str) for value in values):
        raise TypeError("wanted a list of names")
    return tuple(values)


def _numbers(values: Any) -> tuple[float, ...]:
    if not isinstance(values, list):
        raise TypeError("wanted a list of numbers")
    return tuple(map(float, values))
