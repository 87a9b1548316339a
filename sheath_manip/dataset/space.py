"""What the numbers of an episode mean: names of features and actions, and the actions' bounds."""

from dataclasses import dataclass
from typing import Any

from numpy.typing import NDArray

from sheath_manip.dataset.fields import Fields, Read, number, rows_of, word
from sheath_manip.files.json_files import strict_float
from sheath_manip.types import TaskSpec

MOST_NAMES = 100_000
"""of features, actions or choices"""


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
    def from_json(cls, value: Any) -> "Space":
        """Return what `to_json` gave; raises ValueError for anything else.

        The lists must agree in length.
        """
        fields = Fields(value)
        words, numbers = rows_of(word, MOST_NAMES), rows_of(number, MOST_NAMES)
        space = cls(
            fields.take("feature_names", words),
            fields.take("action_names", words),
            fields.take("action_minimum", numbers),
            fields.take("action_maximum", numbers),
            fields.take("action_choices", _or_none(rows_of(numbers, MOST_NAMES))),
        )
        fields.require_empty()
        size = len(space.action_names)
        rows = (space.action_minimum, space.action_maximum, *(space.action_choices or ()))
        if any(len(row) != size for row in rows):
            raise ValueError(f"wanted bounds and choices of {size} numbers, as there are actions")
        return space


def _or_none(read: Read) -> Read:
    return lambda value: None if value is None else read(value)


def _plain(values: NDArray) -> tuple[float, ...]:
    return tuple(float(value) for value in values)
