"""A gate with sliders on the page: its threshold, and nu where its training states are there."""

from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from sheath_manip.dashboard.part import Maker
from sheath_manip.dashboard.parts.threshold import NuSlider, ThresholdSlider
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.gates.adjustable import Adjustable, Boundary, Dial, around
from sheath_manip.gates.support import SupportGate
from sheath_manip.learning.checkpoint import Checkpoint
from sheath_manip.learning.fitting import with_nu
from sheath_manip.learning.training_data import TrainedOn, trained_on
from sheath_manip.types import TaskSpec
from sheath_manip.types.samples import Samples


@dataclass(frozen=True, eq=False)
class Adjusting:
    """What a run and its page need."""

    gate: Adjustable
    parts: tuple[Maker, ...]
    """of the page"""
    states: Samples | None
    """that the checkpoint was fitted to, where they are known"""


def adjusted(checkpoint: Checkpoint, store: Path | None, spec: TaskSpec) -> Adjusting:
    """The gate of `checkpoint` on a task of `spec`; `store` has the episodes it was fitted to.

    Raises StoreError where `store` is none or of another spec, and ParameterError where it lacks
    the episodes.
    """
    seen = None if store is None else trained_on(EpisodeStore(store), checkpoint, spec)
    dial = Dial(_boundary(checkpoint, seen))
    gate = support_gate(checkpoint)
    parts: tuple[Maker, ...] = (partial(ThresholdSlider, dial=dial),)
    nu = checkpoint.signal_choice.hyperparameters.get("nu")
    if seen is not None and nu is not None:

        def refit(nu: float) -> Boundary:
            return _boundary(with_nu(checkpoint, seen.states, seen.calibration, nu), seen)

        parts = (*parts, partial(NuSlider, dial=dial, refit=refit, nu=float(nu)))
    return Adjusting(Adjustable(gate, dial), parts, None if seen is None else seen.states)


def support_gate(checkpoint: Checkpoint) -> SupportGate:
    """The gate that goes by what the checkpoint learned."""
    return SupportGate(
        checkpoint.score,
        checkpoint.threshold,
        release_margin=checkpoint.release_margin,
        why=checkpoint.reason,
    )


def _boundary(checkpoint: Checkpoint, seen: TrainedOn | None) -> Boundary:
    scores = [] if seen is None else [checkpoint.scores(each) for each in seen.calibration]
    return around(checkpoint.score, checkpoint.threshold, np.concatenate([[], *scores]))
