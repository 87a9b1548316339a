"""A gate with sliders on the page: its threshold, and nu where its training states are there."""

from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np

from sheath_manip.dashboard.explainer import Explainer, MakeEnvironment
from sheath_manip.dashboard.reference import WITHOUT_IMAGES, GateReference
from sheath_manip.dashboard.widget import WidgetFactory
from sheath_manip.dashboard.widgets.nu import NuSlider
from sheath_manip.dashboard.widgets.what_if import WhatIf
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.gates.adjustable import Adjustable, Boundary, Dial, around
from sheath_manip.gates.fitted import FittedGate
from sheath_manip.gates.held_out import HeldOut
from sheath_manip.gates.labels.gate import LabellingGate
from sheath_manip.gates.patient import PatientGate
from sheath_manip.gates.progress import ProgressGate
from sheath_manip.gates.support import SupportGate
from sheath_manip.learning.checkpoint import Checkpoint, load_checkpoint
from sheath_manip.learning.fitting import Looks, looks_of, with_nu
from sheath_manip.learning.training_data import load_training_data
from sheath_manip.protocols import Environment, Gate
from sheath_manip.rollout.cached_expert import CachedExpert
from sheath_manip.rollout.request import Crew
from sheath_manip.task import SCRIPTED, Task
from sheath_manip.types import TaskSpec
from sheath_manip.types.samples import Samples


@dataclass(frozen=True, eq=False)
class AdjustedPolicy:
    """A policy under the gate of its checkpoint, whose boundary a person moves while it runs."""

    checkpoint: Path
    dial: Dial
    expert: str = SCRIPTED

    def crew(self, task: Task, environment: Environment) -> Crew:
        """Read the checkpoint, and make its gate and the expert."""
        checkpoint = load_checkpoint(self.checkpoint, environment.spec)
        expert = CachedExpert(task.make_expert(environment, self.expert))
        return Crew(adjustable(checkpoint, self.dial), checkpoint.policy, expert)


@dataclass(frozen=True, eq=False)
class Adjusting:
    """What a run and its page need."""

    driver: AdjustedPolicy
    widgets: tuple[WidgetFactory, ...]
    """Factories of the page's further widgets."""
    states: Samples | None
    """States that the checkpoint was fitted to, where they are known."""
    explainer: Explainer
    """Says on the page why the gate asks."""


def adjustable(checkpoint: Checkpoint, dial: Dial) -> Gate:
    """Return the checkpoint's gate, at the boundary of `dial` where it has one."""
    return _with_dial(checkpoint.gate(), dial)


def _with_dial(gate: Gate, dial: Dial) -> Gate:
    if isinstance(gate, LabellingGate | PatientGate | ProgressGate):
        gate.gate = _with_dial(gate.gate, dial)
        return gate
    return Adjustable(gate, dial) if isinstance(gate, SupportGate) else gate


def adjusted(
    path: Path,
    checkpoint: Checkpoint,
    store: Path | None,
    spec: TaskSpec,
    make: MakeEnvironment | None = None,
) -> Adjusting:
    """Return the sliders for the gate of `checkpoint`, which lies at `path`.

    `make` gives environments of recorded scenes, for the page to look a second ahead.

    `store` has the episodes that it was fitted to. Raises StoreError where it is none or one does
    not fit `spec`, and ParameterError where it lacks the episodes.
    """
    fitted = checkpoint.fitted
    if fitted.signal is None:
        # There is no boundary to move; what makes the gate says why, if that is wanted.
        nowhere = Boundary(fitted, 0.0, -1.0, 1.0)
        return Adjusting(AdjustedPolicy(path, Dial(nowhere)), (), None, Explainer(spec, None, make))
    data = None if store is None else load_training_data(EpisodeStore(store), checkpoint, spec)
    looks = (
        None
        if data is None
        else looks_of(fitted.policy, fitted.signal, data.states, data.calibration)
    )
    dial = Dial(_boundary(fitted, looks))
    widgets: tuple[WidgetFactory, ...] = (partial(WhatIf, dial=dial),)
    config = fitted.config
    if looks is not None and config.support_has_nu:

        def refit(nu: float) -> Boundary:
            return _boundary(with_nu(fitted, looks, nu), looks)

        widgets = (*widgets, partial(NuSlider, dial=dial, refit=refit, nu=config.support.nu))
    states = None if data is None else data.states

    def load() -> GateReference:
        # A copy of its own, which no control loop asks; the states are in memory once.
        return replace(GateReference.load(path, spec, None), states=states, lacks=lacks)

    lacks = "" if data is not None else WITHOUT_IMAGES
    return Adjusting(AdjustedPolicy(path, dial), widgets, states, Explainer(spec, load, make))


def _boundary(fitted: FittedGate, looks: Looks | None) -> Boundary:
    if looks is not None and not fitted.held_out.episodes:
        # An older version wrote it.
        scores = [fitted.scores_of(each) for each in looks.calibration]
        fitted = replace(fitted, held_out=HeldOut.of(scores))
    return around(fitted, fitted.threshold, np.concatenate([[], *fitted.held_out.episodes]))


def scenes_of(task: Task) -> MakeEnvironment:
    """Return what makes an environment of a recorded episode's scene."""
    return lambda info: task.make_for_run(info.variant or "default", info.run_seed)
