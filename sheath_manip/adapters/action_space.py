"""A gymnasium action space as an ActionSpec, and our actions as its own."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from gymnasium import spaces
from numpy.typing import ArrayLike

from sheath_manip.exceptions import ParameterError
from sheath_manip.types import Action, ActionSpec


@dataclass(frozen=True)
class ActionLayout:
    """How actions of the space stand in an (a,) array."""

    space: spaces.Box | spaces.Discrete
    spec: ActionSpec

    @classmethod
    def of(
        cls,
        space: spaces.Space,
        names: Sequence[str] | None = None,
        bounds: tuple[ArrayLike, ArrayLike] | None = None,
        tolerance: float = 0.1,
    ) -> Self:
        """Return the layout of `space`.

        Args:
            space: a Discrete, or a Box of numbers that are no integers.
            names: of its dimensions; by default action_0, action_1 and so on.
            bounds: the least and the greatest action, where the space has none of its own.
            tolerance: of the spec, where actions are continuous.

        Raises ParameterError for another space, and for one without bounds.
        """
        if isinstance(space, spaces.Discrete):
            first, count = int(space.start), int(space.n)
            choices = np.arange(first, first + count, dtype=np.float32)[:, None]
            return cls(space, ActionSpec(_named(names, 1), choices[0], choices[-1], choices))
        if not isinstance(space, spaces.Box) or not np.issubdtype(space.dtype, np.floating):
            raise ParameterError(
                f"the action space is {space}; wanted Discrete, or Box of floating-point numbers, "
                "such as by a wrapper around the environment"
            )
        low, high = (space.low, space.high) if bounds is None else bounds
        shape = space.shape
        minimum, maximum = (
            np.broadcast_to(np.asarray(each, np.float32), shape).ravel() for each in (low, high)
        )
        if not (np.isfinite(minimum) & np.isfinite(maximum)).all():
            raise ParameterError(
                f"the action space {space} has infinite bounds; wanted bounds=(LEAST, GREATEST), "
                "such as bounds=(-1, 1)"
            )
        return cls(
            space, ActionSpec(_named(names, minimum.size), minimum, maximum, tolerance=tolerance)
        )

    def given(self, action: Action) -> Any:
        """Return a validated action as the environment wants it."""
        if isinstance(self.space, spaces.Discrete):
            return int(action[0])
        return action.reshape(self.space.shape).astype(self.space.dtype)

    def taken(self, action: Any) -> Action:
        """(a,) float32 of an action of the space, within its bounds, as an expert's may not be."""
        flat = np.asarray(action, np.float32).ravel()
        if flat.shape != self.spec.minimum.shape:
            raise ParameterError(
                f"the expert's action has {flat.size} numbers; wanted {self.spec.minimum.size} "
                f"({', '.join(self.spec.names)})"
            )
        return np.clip(flat, self.spec.minimum, self.spec.maximum)


def _named(names: Sequence[str] | None, size: int) -> tuple[str, ...]:
    if names is None:
        return ("action",) if size == 1 else tuple(f"action_{number}" for number in range(size))
    if len(names) != size:
        raise ParameterError(f"{len(names)} action names; wanted {size}")
    return tuple(names)
