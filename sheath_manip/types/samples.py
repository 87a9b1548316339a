"""Labelled states for training, held in RAM."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError
from sheath_manip.types.columns import ACTORS
from sheath_manip.types.episode import Episode
from sheath_manip.types.step import Actor, Observations

EXPERT = ACTORS.index(Actor.EXPERT)


@dataclass(frozen=True, eq=False)
class Samples:
    """n states of one or more episodes, labelled where nothing else is said."""

    images: Mapping[str, NDArray[np.uint8]]
    """(n, h, w, 3) RGB by camera"""
    features: NDArray[np.float32]
    """(n, f)"""
    labels: NDArray[np.float32]
    """(n, a) the expert's actions; NaN for a state without a label"""
    episodes: NDArray[np.int64]
    """(n,) which episode each state is from, for splits by episode"""
    steps: NDArray[np.int32] = None  # pyright: ignore[reportAssignmentType]
    """(n,) the control step of its episode; where nothing is said, counted as they come"""
    actors: NDArray[np.uint8] = None  # pyright: ignore[reportAssignmentType]
    """(n,) who acted then, as a place in ACTORS; where nothing is said, the expert"""

    def __post_init__(self) -> None:
        if self.steps is None:
            object.__setattr__(self, "steps", _counted(self.episodes))
        if self.actors is None:
            object.__setattr__(self, "actors", np.full(len(self.episodes), EXPERT, np.uint8))

    def __len__(self) -> int:
        return len(self.labels)

    @property
    def observations(self) -> Observations:
        """The states without their labels."""
        return Observations(self.images, self.features)

    def take(self, indices: NDArray) -> "Samples":
        """The states at `indices` (integers or a mask)."""
        return Samples(
            {camera: images[indices] for camera, images in self.images.items()},
            self.features[indices],
            self.labels[indices],
            self.episodes[indices],
            self.steps[indices],
            self.actors[indices],
        )

    @property
    def is_labelled(self) -> NDArray[np.bool_]:
        """(n,) which states have a label."""
        return np.isfinite(self.labels[:, 0])

    def labelled(self) -> "Samples":
        """The states with a label."""
        has = self.is_labelled
        return self if has.all() else self.take(has)


def samples_from(episodes: Iterable[Episode]) -> Samples:
    """Return all labelled states of `episodes`; raises ParameterError where there is none."""
    visited = list(episodes)
    if not any(episode.columns.has_label.any() for episode in visited):
        raise ParameterError(
            "no labelled state to train on; record episodes whose gate asks for labels"
        )
    return visited_from(visited, labelled_only=True)


def visited_from(episodes: Iterable[Episode], labelled_only: bool = False) -> Samples:
    """Return all states of `episodes`, also those that nobody labelled, or only the others."""
    rows = [
        (number, episode, episode.columns.has_label if labelled_only else slice(None))
        for number, episode in enumerate(episodes)
    ]
    cameras = rows[0][1].final_observation.images
    columns = [(number, episode.columns, chosen) for number, episode, chosen in rows]
    steps = [np.arange(len(each), dtype=np.int32)[chosen] for _, each, chosen in columns]
    return Samples(
        {
            camera: np.concatenate([episode.images(camera)[chosen] for _, episode, chosen in rows])
            for camera in cameras
        },
        np.concatenate([each.features[chosen] for _, each, chosen in columns]).astype(np.float32),
        np.concatenate([each.labels[chosen] for _, each, chosen in columns]),
        np.concatenate([np.full(len(each), number)[chosen] for number, each, chosen in columns]),
        np.concatenate(steps),
        np.concatenate([each.actor[chosen] for _, each, chosen in columns]),
    )


def joined(parts: Sequence[Samples]) -> Samples:
    """Return one batch of all `parts`, their episodes numbered apart."""
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
        np.concatenate([part.steps for part in parts]),
        np.concatenate([part.actors for part in parts]),
    )


def _counted(episodes: NDArray[np.int64]) -> NDArray[np.int32]:
    """(n,) how many states of the same episode come before."""
    order = np.argsort(episodes, kind="stable")
    _, first, counts = np.unique(episodes[order], return_index=True, return_counts=True)
    steps = np.empty(len(episodes), np.int32)
    steps[order] = np.arange(len(episodes)) - np.repeat(first, counts)
    return steps
