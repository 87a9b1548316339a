"""Fits the gate of a fitted policy: signal and threshold, each state looked at once."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError
from sheath_manip.gates.config import GateConfig, planned_signal
from sheath_manip.gates.fitted import FittedGate, Sources
from sheath_manip.gates.held_out import HeldOut
from sheath_manip.gates.progress import Progress
from sheath_manip.policies.looking import look, look_to_fit
from sheath_manip.protocols import Agreement, HasFloor, PredictingPolicy, Refits, Signal
from sheath_manip.seeding import generator
from sheath_manip.signals import make_signal
from sheath_manip.support.calibration import (
    held_out_threshold,
    or_reject_all,
    planned_threshold,
)
from sheath_manip.support.reach import warn_out_of_reach
from sheath_manip.types.samples import Samples
from sheath_manip.types.seen import Seen

MOST_STATES = 50_000
"""that a gate is fitted to: while it is fitted each takes up to 12 kB, and each step of a robot is
compared with all of them, which takes 1.4 ms for so many"""
BUDGET = "budget"
"""the threshold rule that asks what the policy met last"""


@dataclass(frozen=True, eq=False)
class Looks:
    """What one policy saw of all that its gate is fitted to and calibrated on."""

    labels: NDArray[np.float32]
    """(n, a) of these training states"""
    states: Seen
    """n training states: all, or as many as a gate is fitted to"""
    calibration: Sequence[Seen]
    """expert episodes that no fit has seen"""
    visited: Seen | None = None
    """all states of the last round's episodes, where a budget asks for them"""


@dataclass(frozen=True, eq=False)
class Fit:
    """A gate, and what was looked at for it."""

    gate: FittedGate
    looks: Looks

    @property
    def training_loss(self) -> float:
        """Mean surrogate loss of the policy on its training states, which the same look shows."""
        assert self.looks.states.losses is not None
        return float(np.mean(self.looks.states.losses))


def looks_of(
    policy: PredictingPolicy,
    signal: Signal,
    states: Samples,
    calibration: Sequence[Samples],
    visited: Samples | None = None,
) -> Looks:
    """Look at everything once, with all that `signal` reads; it is attached to the policy.

    Of more than `MOST_STATES` training states only `fitted_rows` are looked at.
    """
    readers = signal.attach(policy)
    states = states if len(states) <= MOST_STATES else states.take(fitted_rows(len(states)))
    return Looks(
        np.asarray(states.labels),
        look_to_fit(policy, states, signal),
        [look(policy, episode, readers) for episode in calibration],
        None if visited is None else look(policy, visited, readers),
    )


def fitted_rows(count: int) -> NDArray[np.int64]:
    """Return which of `count` training states a gate is fitted to, in their order.

    All of them, or `MOST_STATES` drawn evenly, the same ones whenever there are so many: so that a
    refit costs the same however much has been aggregated.
    """
    if count <= MOST_STATES:
        return np.arange(count)
    rng = generator("fitted states", count)
    return np.sort(rng.choice(count, MOST_STATES, replace=False))


def fit_gate(
    policy: PredictingPolicy,
    states: Samples,
    calibration: Sequence[Samples],
    config: GateConfig,
    *,
    sources: Sources,
    agreement: Agreement | None = None,
    previous: FittedGate | None = None,
    visited: Samples | None = None,
) -> Fit:
    """Fit the signal of `config` to the policy's training `states`, and calibrate the threshold.

    Where too many states have no score for any threshold, the gate takes none for inside. Warns
    (GateWarning) where hardly any state can score below the threshold: `support.reach`.

    Args:
        policy: fitted to `states`.
        states: that it was trained on.
        calibration: expert episodes that no fit has seen, one `Samples` each.
        config: names signal, embedding, support and rule.
        sources: the names of all these episodes.
        agreement: for supports that ask where the policy is right.
        previous: of the round before, whose threshold stays where `config` calibrates only once.
        visited: all states of the last round's episodes, for a budget; where there are none yet,
            the calibration episodes stand in.
    """
    signal = make_signal(planned_signal(config))
    asked = visited if config.threshold.rule == BUDGET else None
    looks = looks_of(policy, signal, states, calibration, asked)
    asking = None if agreement is None else _of_rows(agreement, fitted_rows(len(states)))
    fitted = fit_to_looks(
        policy, signal, looks, config, sources=sources, agreement=asking, previous=previous
    )
    return Fit(fitted, looks)


def _of_rows(agreement: Agreement, rows: NDArray[np.int64]) -> Agreement:
    return lambda: agreement()[rows]


def fit_to_looks(
    policy: PredictingPolicy,
    signal: Signal,
    looks: Looks,
    config: GateConfig,
    *,
    sources: Sources,
    agreement: Agreement | None = None,
    previous: FittedGate | None = None,
) -> FittedGate:
    """Fit `signal`, unfitted and attached to `policy`, to what was looked at already."""
    measures = _calibrated(signal.fit(looks.labels, looks.states, agreement), looks)
    expert = [seen.features for seen in looks.calibration]
    progress = Progress.of(expert, config.stuck_steps) if config.stuck_steps else None
    fitted = FittedGate(config, policy, signal, sources=sources, progress=progress)
    if previous is not None and not config.threshold.recalibrate:
        kept = replace(
            fitted,
            threshold=previous.threshold,
            release_margin=previous.release_margin,
            held_out=HeldOut.of([signal.scores(each) for each in measures]),
        )
        return _checked(kept, len(measures))
    return _with_threshold(fitted, measures, looks.visited)


def recalibrated(
    fitted: FittedGate, calibration: Sequence[Samples], visited: Samples | None = None
) -> FittedGate:
    """Find the threshold again, for a gate that stays as it is."""
    policy, signal, readers = fitted.policy, fitted.fitted_signal, fitted.readers
    measures = [signal.measure(look(policy, episode, readers)) for episode in calibration]
    asked = fitted.config.threshold.rule == BUDGET and visited is not None
    met = look(policy, visited, readers) if asked and visited is not None else None
    return _with_threshold(fitted, measures, met)


def with_nu(fitted: FittedGate, looks: Looks, nu: float) -> FittedGate:
    """Fit the support anew to the training states, of which `nu` may be outside.

    Policy and embedding stay; the threshold is found again by the same rule.
    Raises ParameterError where the support has no nu, or cannot be fitted to states alone.
    """
    config = replace(fitted.config, support=replace(fitted.config.support, nu=nu))
    choice = planned_signal(config)
    if "nu" not in choice.hyperparameters:
        raise ParameterError(
            f"the support {choice.support} has no nu; wanted one such as one-class-svm"
        )
    signal = make_signal(choice)
    signal.attach(fitted.policy)
    signal.load(fitted.fitted_signal.arrays())
    if not isinstance(signal, Refits):
        raise ParameterError(f"the signal {choice.signal} has no support to be fitted anew")
    signal.refit(looks.states)
    measures = _calibrated(signal, looks)
    return _with_threshold(replace(fitted, config=config, signal=signal), measures, looks.visited)


def _calibrated(signal: Signal, looks: Looks) -> list[NDArray[np.float64]]:
    """The measures of the held-out episodes, from which the signal has learned."""
    measures = [signal.measure(seen) for seen in looks.calibration]
    signal.calibrate(measures)
    return measures


def _with_threshold(
    fitted: FittedGate, measures: Sequence[NDArray], visited: Seen | None
) -> FittedGate:
    """With its threshold, and how far above it the expert hands back."""
    signal, config = fitted.fitted_signal, fitted.config
    held_out = [signal.scores(each) for each in measures]
    met = held_out if visited is None else [fitted.scores_of(visited)]
    threshold = planned_threshold(held_out, met, config.threshold)
    margin = 0.0
    if config.release_rate > 0:
        release = or_reject_all(lambda: held_out_threshold(held_out, config.release_rate))
        margin = max(0.0, release - threshold)
    found = replace(
        fitted, threshold=threshold, release_margin=margin, held_out=HeldOut.of(held_out)
    )
    return _checked(found, len(measures))


def _checked(fitted: FittedGate, held_out: int) -> FittedGate:
    """The gate, with a warning where it cannot do what it is for; a budget is always spent."""
    if isinstance(fitted.signal, HasFloor) and fitted.config.threshold.rule != BUDGET:
        warn_out_of_reach(fitted.threshold, fitted.signal.far_score, held_out)
    return fitted
