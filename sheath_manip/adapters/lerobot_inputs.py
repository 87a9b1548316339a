"""What a LeRobot policy takes, by the names in its config, and where it is in an observation."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Self

import numpy as np
import torch
from numpy.typing import NDArray

from sheath_manip.exceptions import CheckpointError, ParameterError
from sheath_manip.types import Observations, TaskSpec

PREFIX = "observation."
_VECTORS, _IMAGE = ("STATE", "ENV"), "VISUAL"


@dataclass(frozen=True)
class Inputs:
    """The inputs of one policy: vectors and images by LeRobot's names, and where they come from."""

    vectors: Mapping[str, int]
    """how many numbers, by name: the robot's state, then what LeRobot calls the environment's"""
    images: Mapping[str, tuple[int, int]]
    """(height, width) in pixels, by name"""
    cameras: Mapping[str, str] = field(default_factory=dict)
    """camera of the observation by the image's name, where it is not what follows
    `observation.images.` or `observation.`"""
    features: Mapping[str, Sequence[str]] = field(default_factory=dict)
    """names of features by the vector's name, where the vectors are not simply all features in
    their order"""
    feature_names: Sequence[str] | None = None
    """of the observation; None where they are not known"""

    @classmethod
    def described(cls, config: Mapping[str, Any], **where: Any) -> Self:
        """Return what a policy's `config.json` asks for; raises CheckpointError.

        Args:
            config: its content.
            where: `cameras`, `features` and `feature_names`.
        """
        vectors: dict[str, dict[str, int]] = {kind: {} for kind in _VECTORS}
        images: dict[str, tuple[int, int]] = {}
        try:
            for name, feature in config["input_features"].items():
                kind, shape = feature["type"], feature["shape"]
                if kind == _IMAGE:
                    images[name] = (int(shape[1]), int(shape[2]))
                elif kind in _VECTORS:
                    vectors[kind][name] = int(shape[0])
                else:
                    raise CheckpointError(
                        f"the policy wants {name} of the kind {kind}; wanted one that takes "
                        f"{', '.join(_VECTORS)} and {_IMAGE} alone"
                    )
        except (AttributeError, KeyError, IndexError, TypeError, ValueError) as error:
            raise CheckpointError(
                f"the policy's config.json does not say what it takes ({type(error).__name__}: "
                f"{error}); wanted `input_features` as LeRobot 0.4 writes them"
            ) from error
        # The robot's state first, in whatever order the config has them.
        ordered = {name: width for kind in _VECTORS for name, width in vectors[kind].items()}
        return cls(ordered, images, **where)

    def check(self, spec: TaskSpec) -> None:
        """Raise ParameterError where a task does not show what the policy takes."""
        self._columns(len(spec.feature_names))
        for name, size in self.images.items():
            self._check_size(name, size, spec.cameras[self._camera(name, spec.cameras)])

    def batch(self, observations: Observations) -> dict[str, torch.Tensor]:
        """Return the inputs of n observations as LeRobot wants them before its own preprocessing.

        Vectors are (n, d) float32, images (n, 3, h, w) float32 in 0..1. Raises ParameterError.
        """
        shown: dict[str, torch.Tensor] = {}
        for name, columns in self._columns(observations.features.shape[1]).items():
            # A copy, since torch warns of arrays that cannot be written to.
            taken = np.array(observations.features[:, columns], np.float32)
            shown[name] = torch.from_numpy(taken)
        for name, size in self.images.items():
            images = observations.images[self._camera(name, observations.images)]
            self._check_size(name, size, images.shape[1:3])
            pixels = torch.from_numpy(np.array(images)).permute(0, 3, 1, 2)
            shown[name] = pixels.contiguous().to(torch.float32) / 255
        return shown

    def _camera(self, name: str, there: Mapping[str, Any]) -> str:
        named = self.cameras.get(name)
        if named is None and name == f"{PREFIX}image" and len(there) == 1:
            return next(iter(there))
        # As the import of LeRobot's data sets names them.
        camera = name.removeprefix(PREFIX).removeprefix("images.") if named is None else named
        if camera in there:
            return camera
        raise ParameterError(
            f"the policy wants {name} of a camera {camera!r}, the observation has "
            f"{', '.join(there) or 'no camera'}; say which it is by "
            f"cameras={{{name!r}: ...}}"
        )

    def _check_size(self, name: str, size: tuple[int, int], found: tuple[int, ...]) -> None:
        if tuple(found) != size:
            raise ParameterError(
                f"the policy wants {name} of {size[0]} x {size[1]} px (height x width), the camera "
                f"gives {found[0]} x {found[1]} px; wanted the camera that it was trained with"
            )

    def _columns(self, count: int) -> dict[str, NDArray[np.int64] | slice]:
        """Which of so many features make each vector."""
        if self.features:
            return self._named_columns()
        widths = list(self.vectors.values())
        if all(width == count for width in widths):
            return {name: slice(None) for name in self.vectors}
        if sum(widths) == count:
            ends = np.cumsum(widths)
            return {
                name: slice(int(end) - width, int(end))
                for (name, width), end in zip(self.vectors.items(), ends, strict=True)
            }
        wanted = " and ".join(f"{name} of {width}" for name, width in self.vectors.items())
        raise ParameterError(
            f"the policy wants {wanted} numbers, the observation has {count} features"
            f"{self._listed()}; say which they are by features={{{next(iter(self.vectors))!r}: "
            "[...]}"
        )

    def _named_columns(self) -> dict[str, NDArray[np.int64] | slice]:
        if self.feature_names is None:
            raise ParameterError(
                "features are named, but not known by name; wanted the task's spec beside them"
            )
        places = {name: place for place, name in enumerate(self.feature_names)}
        columns: dict[str, NDArray[np.int64] | slice] = {}
        for name, width in self.vectors.items():
            named = self.features.get(name, ())
            unknown = [each for each in named if each not in places]
            if unknown or len(named) != width:
                found = f"unknown: {', '.join(unknown)}" if unknown else f"{len(named)} are named"
                raise ParameterError(
                    f"the policy wants {name} of {width} numbers, {found}; wanted so many of the "
                    f"observation's features{self._listed()}"
                )
            columns[name] = np.array([places[each] for each in named], np.int64)
        return columns

    def _listed(self) -> str:
        return f" ({', '.join(self.feature_names)})" if self.feature_names else ""
