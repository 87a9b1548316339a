"""What comes after a state and what came before it, within what one actor did in one episode."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError
from sheath_manip.types.samples import Samples
from sheath_manip.types.step import Observations


@dataclass(frozen=True, eq=False)
class Chunks:
    """The next k labels of n states."""

    labels: NDArray[np.float32]
    """(n, k, a); behind a gap the last one before it, repeated"""
    known: NDArray[np.bool_]
    """(n, k) which are labels of the steps that they stand for; the first one is"""


def chunk_targets(samples: Samples, length: int) -> Chunks:
    """Return for each labelled state its own label and those of the next steps.

    A chunk ends before a gap: a change of who acts, a step without a label, the episode's end. What
    another does is not how this one would have gone on. Raises ParameterError for a length below 1
    and for a state without a label.
    """
    if length < 1:
        raise ParameterError(f"a chunk's length is {length}; wanted at least 1 action")
    if not samples.is_labelled.all():
        raise ParameterError("a state has no label to begin a chunk with; wanted labelled states")
    rows, known = _rows(samples, length, by_actor=True)
    return Chunks(samples.labels[rows], known)


def last_observations(samples: Samples, length: int) -> tuple[Observations, NDArray[np.bool_]]:
    """Return the last h observations of each state, its own last, and which of them there were.

    Before the first known step the earliest observation is repeated: an episode begins, or steps
    are missing. A change of who acts is no gap: the observations are what was seen all the same.

    Returns:
        Images of (n, h, height, width, 3) and features of (n, h, f), and (n, h) which are those of
        the steps that they stand for. Raises ParameterError for a length below 1.
    """
    if length < 1:
        raise ParameterError(f"a history's length is {length}; wanted at least 1 observation")
    rows, known = _rows(samples, length, by_actor=False, backwards=True)
    rows, known = rows[:, ::-1], known[:, ::-1]
    images = {camera: images[rows] for camera, images in samples.images.items()}
    return Observations(images, samples.features[rows]), known


def _rows(
    samples: Samples, length: int, *, by_actor: bool, backwards: bool = False
) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """(n, length) rows of the states that follow each, and which of them do follow."""
    keys = (-samples.steps if backwards else samples.steps), samples.episodes
    order = np.lexsort(keys)
    episodes, steps, actors = samples.episodes[order], samples.steps[order], samples.actors[order]
    follows = (np.diff(episodes) == 0) & (np.abs(np.diff(steps)) == 1)
    if by_actor:
        follows &= np.diff(actors.astype(np.int16)) == 0
    # How many states follow one another from each on.
    ends = np.flatnonzero(np.r_[~follows, True]) if len(order) else np.empty(0, np.int64)
    places = np.arange(len(order))
    last = ends[np.searchsorted(ends, places)]
    ahead = places[:, None] + np.arange(length)
    rows, known = np.empty((2, len(order), length), np.int64)
    rows[order] = order[np.minimum(ahead, last[:, None])]
    known[order] = ahead <= last[:, None]
    return rows, known.astype(bool)
