"""All that one drawing of the page shows."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sheath_manip.dashboard.tally import Figures, Scored
from sheath_manip.types import Actor, SceneGeom


@dataclass(frozen=True, eq=False)
class Moment:
    """All that one drawing shows."""

    scene: tuple[SceneGeom, ...]
    """the same object throughout an episode"""
    body_poses: NDArray[np.float64]
    """(b, 7)"""
    figures: Figures
    scores: tuple[Scored, ...]
    """of the latest steps"""
    trail: tuple[tuple[float, float, Actor], ...]
    """x and y (metres, in `TaskSpec.plane`) and who acted, of the latest steps"""
    images: Mapping[str, NDArray[np.uint8]]
    """(h, w, 3) RGB by camera"""
    training: NDArray[np.float64] | None
    """(n, 2) metres in `TaskSpec.plane`; the same object until the policy is fitted anew"""
    paused: bool
    """whether a person holds the run"""
