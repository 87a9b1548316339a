"""Labelled states for training, held in RAM."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError
from sheath_manip.types import Episode


@dataclass(frozen=True, eq=False)
class Samples:
    """n labelled states of one or more episodes."""

    images: Mapping[str, NDArray[np.uint8]]
    """(n, h, w, 3) RGB by camera"""
    features: NDArray[np.float32]
    """(n, f)"""
    labels: NDArray[np.float32]
    """(n, a) the expert's actions"""
    episodes: NDArray[np.int64]
    """(n,) which episode each state is from, for splits by episode"""

    def __len__(self) -> int:
        return len(self.labels)

    def take(self, indices: NDArray) -> "Samples":
        """The states at `indices` (integers or a mask)."""
        return Samples(
            {camera: images[indices] for camera, images in self.images.items()},
            self.features[indices],
            self.labels[indices],
            self.episodes[indices],
        )


def samples_from(episodes: Iterable[Episode]) -> Samples:
    """All labelled states of `episodes`; raises ParameterError where there is none."""
    steps = [
        (number, step)
        for number, episode in enumerate(episodes)
        for step in episode.steps
        if step.labelled is not None
    ]
    if not steps:
        raise ParameterError(
            "no labelled state to train on; record episodes whose gate asks for labels"
        )
    cameras = steps[0][1].observation.images
    return Samples(
        {
            camera: np.stack([step.observation.images[camera] for _, step in steps])
            for camera in cameras
        },
        np.stack([step.observation.features for _, step in steps]).astype(np.float32),
        np.stack([step.labelled for _, step in steps if step.labelled is not None]),
        np.array([number for number, _ in steps], dtype=np.int64),
    )


def joined(parts: Sequence[Samples]) -> Samples:
    """One batch of all `parts`, their episodes numbered apart."""
    offsets = np.cumsum([0, *(int(part.episodes.max()) + 1 for part in parts)])
    return Samples(
        {
            camera: np.concatenate([part.images[camera] for part in parts])
            for camera in parts[0].images
        },
        np.concatenate([part.features for part in parts]),
        np.concatenate([part.labels for part in parts]),
        np.concatenate(
            [part.episodes + offset for part, offset in zip(parts, offsets, strict=False)]
        ),
    )
