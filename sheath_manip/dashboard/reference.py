"""What a gate was fitted to, for a page to compare with: its training states and their images."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Self

import numpy as np
from numpy.typing import NDArray

from sheath_manip.dataset.reader import EpisodeReader
from sheath_manip.exceptions import ParameterError, StoreError
from sheath_manip.gates.fitted import FittedGate
from sheath_manip.learning.checkpoint import load_checkpoint
from sheath_manip.learning.training_data import load_training_data
from sheath_manip.policies.looking import seen_in
from sheath_manip.protocols import HasPrecedents
from sheath_manip.types import Action, Observation, TaskSpec
from sheath_manip.types.samples import Samples
from sheath_manip.types.seen import Precedents

LEAST_ALIKE, MOST_ALIKE, ALIKE_SHARE = 3, 200, 0.05
"""of training states that count as like one: the nearest twentieth, within these bounds"""


WITHOUT_IMAGES = "No images: --training-store says where the states are kept."


@dataclass(frozen=True, eq=False)
class GateReference:
    """A gate that no control loop uses, and the states that it was fitted to."""

    fitted: FittedGate
    states: Samples | None
    """in the order of the fit, with their images; None where they cannot be read"""
    lacks: str = ""
    """why not, in a sentence"""

    @classmethod
    def load(cls, checkpoint: Path, spec: TaskSpec, reader: EpisodeReader | None) -> Self:
        """Read the gate of `checkpoint`, and its states from the store of `reader`.

        Raises CheckpointError; a store that cannot be read, or has not all of them, is only told.
        """
        read = load_checkpoint(checkpoint, spec)
        if reader is None:
            return cls(read.fitted, None, WITHOUT_IMAGES)
        try:
            return cls(read.fitted, load_training_data(reader, read, spec).states)
        except (StoreError, ParameterError) as error:
            return cls(read.fitted, None, f"No images: {error}.")

    @property
    def held_out_steps(self) -> int:
        """The number of the expert's steps that shares are taken of; 0 where it is not known."""
        return sum(map(len, self.fitted.held_out.episodes))

    def precedents(self, observation: Observation, proposed: Action) -> Precedents | None:
        """Return the training states like this one; None where the gate compares with none.

        The policy looks again, since a recording keeps no latents; the action judged is the one
        that was proposed then.
        """
        signal = self.fitted.signal
        if not isinstance(signal, HasPrecedents):
            return None
        proposal = self.fitted.policy.predict(observation.alone)
        seen = seen_in(observation, proposal, self.fitted.readers)
        found = signal.nearest_states(replace(seen, actions=proposed[None]), MOST_ALIKE)
        if found is None:
            return None
        alike = int(np.clip(ALIKE_SHARE * found.total, LEAST_ALIKE, MOST_ALIKE))
        return Precedents(
            found.indices[:alike],
            found.distances[:alike],
            found.labels[:alike],
            found.proposed,
            found.total,
        )

    def lacks_of(self, precedents: Precedents) -> str:
        """Return in a sentence why there are no images of `precedents`; empty where there are."""
        if self.states is not None and len(self.states) != precedents.total:
            return (
                f"No images: the store has {len(self.states):,} labelled states, the gate was "
                f"fitted to {precedents.total:,}."
            )
        return self.lacks

    def image(self, precedents: Precedents, place: int) -> NDArray[np.uint8] | None:
        """Return what the cameras saw in one of `precedents`; None where that cannot be read."""
        states = self.states
        if states is None or not states.images or self.lacks_of(precedents):
            return None
        index = int(precedents.indices[place])
        return stacked_views([images[index] for images in states.images.values()])


def stacked_views(images: list[NDArray[np.uint8]]) -> NDArray[np.uint8] | None:
    """Return the cameras' images one above the other, cut to the narrowest; None without any."""
    if not images:
        return None
    width = min(image.shape[1] for image in images)
    return np.concatenate([image[:, :width] for image in images])
