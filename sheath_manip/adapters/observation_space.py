"""A gymnasium observation space as cameras and named features, and its observations as ours."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError
from sheath_manip.types import Observation

BARE = "observation"
"""the key of a space that is no Dict"""
MOST = 1024
"""numbers of one key: more of them are a picture in another form, or points, and no features"""
TAKEN = (
    f"taken are images of uint8 (h, w, 3) or (3, h, w), and numbers, at most {MOST} of a key: Box, "
    "Discrete, MultiBinary and MultiDiscrete, also in Dicts; leave_out=[KEY] leaves others out"
)


@dataclass(frozen=True)
class Leaf:
    """One space that is no Dict, at the end of a path of keys."""

    path: tuple[str, ...]
    space: spaces.Space
    key: str
    """of the path: its parts joined by a dot"""

    def of(self, observation: Any) -> Any:
        """Return its part of an observation."""
        for key in self.path:
            observation = observation[key]
        return observation


@dataclass(frozen=True)
class ObservationLayout:
    """Which parts of an observation are images and which are features, in their order."""

    images: tuple[Leaf, ...]
    features: tuple[Leaf, ...]
    feature_names: tuple[str, ...]

    @classmethod
    def of(
        cls,
        space: spaces.Space,
        names: Mapping[str, Sequence[str]],
        leave_out: Collection[str] = (),
    ) -> Self:
        """Return the layout of `space`.

        Args:
            space: a Box, or a Dict of them, nested as deep as may be.
            names: of features, by key; those of the other keys are KEY_0, KEY_1 and so on.
            leave_out: keys of what the robot is not to see.

        Raises ParameterError for a space that it cannot take, and a key that is not there.
        """
        leaves = list(_leaves(space, ()))
        keys = [leaf.key for leaf in leaves]
        for key in (*names, *leave_out):
            if key not in keys:
                raise ParameterError(f"no observation {key!r}; there are {', '.join(keys)}")
        leaves = [leaf for leaf in leaves if leaf.key not in leave_out]
        images = tuple(leaf for leaf in leaves if _is_image(leaf.space))
        features = tuple(leaf for leaf in leaves if not _is_image(leaf.space))
        named = (name for leaf in features for name in _names(leaf, names.get(leaf.key)))
        return cls(images, features, tuple(named))

    @property
    def cameras(self) -> dict[str, tuple[int, int]]:
        """(height, width) in pixels, by camera."""
        return {leaf.key: _size_px(leaf.space) for leaf in self.images}

    def observed(
        self, observation: Any, time_s: float, more: Mapping[str, NDArray[np.uint8]]
    ) -> Observation:
        """Return what gymnasium calls an observation as ours, with `more` images."""
        images = {leaf.key: _image(leaf.of(observation)) for leaf in self.images}
        parts = [np.ravel(leaf.of(observation)) for leaf in self.features]
        # What float32 cannot hold becomes infinite, which the loop tells of.
        with np.errstate(over="ignore"):
            features = np.concatenate([np.zeros(0), *parts]).astype(np.float32)
        return Observation({**images, **more}, features, time_s)


def _leaves(space: spaces.Space, path: tuple[str, ...]) -> Iterator[Leaf]:
    if isinstance(space, spaces.Dict):
        for key, inner in space.spaces.items():
            yield from _leaves(inner, (*path, str(key)))
    else:
        yield Leaf(path, space, ".".join(path) or BARE)


def _is_image(space: spaces.Space) -> bool:
    shape = space.shape or ()
    return space.dtype == np.uint8 and len(shape) == 3 and 3 in (shape[0], shape[-1])


def _size_px(space: spaces.Space) -> tuple[int, int]:
    shape = list(space.shape or ())
    return (shape[0], shape[1]) if shape[-1] == 3 else (shape[1], shape[2])


def _image(value: Any) -> NDArray[np.uint8]:
    image = np.asarray(value)
    return np.ascontiguousarray(image if image.shape[-1] == 3 else image.transpose(1, 2, 0))


def _names(leaf: Leaf, named: Sequence[str] | None) -> Sequence[str]:
    numbers = spaces.Box | spaces.Discrete | spaces.MultiBinary | spaces.MultiDiscrete
    shape = leaf.space.shape
    if not isinstance(leaf.space, numbers) or shape is None or np.prod(shape) > MOST:
        raise ParameterError(f"observation {leaf.key!r} is {leaf.space}; {TAKEN}")
    size = int(np.prod(shape))
    if named is None:
        return [f"{leaf.key}_{number}" for number in range(size)]
    if len(named) != size:
        raise ParameterError(
            f"{len(named)} feature names of observation {leaf.key!r}; wanted {size}"
        )
    return named
