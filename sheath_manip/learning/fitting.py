"""From a fitted policy to its gate: signal and threshold."""

from collections.abc import Sequence
from dataclasses import replace

from sheath_manip.exceptions import ParameterError
from sheath_manip.gates.config import GateConfig, planned_signal
from sheath_manip.learning.checkpoint import Checkpoint
from sheath_manip.protocols import Agreement, Policy, Refits, Signal
from sheath_manip.signals import make_signal
from sheath_manip.support.calibration import (
    held_out_threshold,
    or_nothing_inside,
    planned_threshold,
)
from sheath_manip.types.samples import Samples


def fit_gate(
    policy: Policy,
    states: Samples,
    calibration: Sequence[Samples],
    config: GateConfig,
    task: str,
    *,
    policy_name: str,
    run_seed: int = 0,
    agreement: Agreement | None = None,
    previous: Checkpoint | None = None,
    visited: Samples | None = None,
    signal: Signal | None = None,
) -> Checkpoint:
    """Fit the signal of `config` to the policy's training `states`, and calibrate the threshold.

    Where too many states have no score for any threshold, the gate takes none for inside.

    Args:
        policy: fitted to `states`.
        states: that it was trained on.
        calibration: expert episodes that no fit has seen, one `Samples` each.
        config: names signal, embedding, support and rule.
        task: name of the task.
        policy_name: of `policy`, in POLICIES.
        run_seed: of the training run.
        agreement: for supports that ask where the policy is right.
        previous: of the round before, whose threshold stays where `config` calibrates only once.
        visited: all states of the last round's episodes, for a budget; where there are none yet,
            the calibration episodes stand in.
        signal: unfitted, as `config` chooses it; made anew where it is not given.
    """
    choice = planned_signal(config)
    signal = make_signal(choice) if signal is None else signal
    signal.fit(policy, states, agreement).calibrate(calibration)
    fitted = Checkpoint(
        task=task,
        policy_name=policy_name,
        policy=policy,
        signal_choice=choice,
        signal=signal,
        threshold=float("nan") if previous is None else previous.threshold,
        release_margin=0.0 if previous is None else previous.release_margin,
        false_alarm_rate=config.threshold.false_alarm_rate,
        method="",
        round=0,
        run_seed=run_seed,
    )
    if previous is not None and not config.threshold.recalibrate:
        return fitted
    return calibrated(fitted, calibration, config, visited)


def calibrated(
    checkpoint: Checkpoint,
    calibration: Sequence[Samples],
    config: GateConfig,
    visited: Samples | None = None,
) -> Checkpoint:
    """`checkpoint` with its threshold, and how far above it the expert hands back."""
    held_out = [checkpoint.scores(episode) for episode in calibration]
    met = held_out if visited is None else [checkpoint.scores(visited)]
    threshold = planned_threshold(held_out, met, config.threshold)
    margin = 0.0
    if config.release_rate > 0:
        release = or_nothing_inside(lambda: held_out_threshold(held_out, config.release_rate))
        margin = max(0.0, release - threshold)
    return replace(checkpoint, threshold=threshold, release_margin=margin)


def with_nu(
    checkpoint: Checkpoint, states: Samples, calibration: Sequence[Samples], nu: float
) -> Checkpoint:
    """`checkpoint` with its support fitted anew to `states`, of which `nu` may be outside.

    Policy and embedding stay; the threshold is found again for the same rate of false alarms.
    Raises ParameterError where the support has no nu, or cannot be fitted to states alone.
    """
    choice = checkpoint.signal_choice
    if "nu" not in choice.hyperparameters:
        raise ParameterError(
            f"the support {choice.support} has no nu; wanted one such as one-class-svm"
        )
    choice = replace(choice, hyperparameters={**choice.hyperparameters, "nu": nu})
    signal = make_signal(choice).load(checkpoint.policy, checkpoint.signal.arrays())
    if not isinstance(signal, Refits):
        raise ParameterError(f"the signal {choice.signal} has no support to be fitted anew")
    signal.refit(states)
    signal.calibrate(calibration)
    fitted = replace(checkpoint, signal_choice=choice, signal=signal)
    held_out = [fitted.scores(episode) for episode in calibration]
    rate = checkpoint.false_alarm_rate
    return replace(fitted, threshold=or_nothing_inside(lambda: held_out_threshold(held_out, rate)))
