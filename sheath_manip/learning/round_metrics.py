"""What the episodes of a round say about the policy that drove them and the gate fitted next."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sheath_manip.learning import theory
from sheath_manip.learning.checkpoint import Checkpoint
from sheath_manip.learning.theory import Bound
from sheath_manip.policies.looking import look
from sheath_manip.protocols import PredictingPolicy
from sheath_manip.types import Columns, Episode, Proposal
from sheath_manip.types.samples import Samples, visited_from


@dataclass(frozen=True)
class RoundMetrics:
    """Metrics of one round; the fields are those of `RoundResult`."""

    false_alarm_rate: float
    missed_rate: float
    surrogate_loss: float
    bound: Bound


def compute_round_metrics(
    episodes: Sequence[Episode],
    driver: Checkpoint,
    fitted: Checkpoint,
    check: Sequence[Samples],
    tolerance: float = 0.0,
) -> RoundMetrics:
    """Return the metrics of one round.

    What the driver proposed and how its gate scored that was recorded, and is not looked at again;
    only demonstrations, which it did not drive, it is shown now.

    Args:
        episodes: of the round. What needs the expert's word (losses, misses) is measured over the
            labelled steps, and is NaN where there are none.
        driver: drove them, or is fitted to them.
        fitted: to the states after them.
        check: new expert episodes.
        tolerance: surrogate loss up to which an action counts as the expert's.
    """
    columns = [episode.columns for episode in episodes]
    labelled = np.concatenate([each.has_label for each in columns])
    acted = np.concatenate([each.by_policy for each in columns])
    if all(episode.info.checkpoint for episode in episodes):
        losses = np.concatenate([_losses(driver.policy, each) for each in columns])
        scores = np.concatenate([each.score for each in columns])
    else:
        losses, scores = _looked_at(driver, visited_from(episodes))
    known = losses[labelled]
    missed = acted[labelled][known > tolerance]
    return RoundMetrics(
        false_alarm_rate=_false_alarm_rate(fitted, check),
        missed_rate=float(missed.mean()) if len(missed) else 0.0,
        surrogate_loss=float(np.mean(known)) if len(known) else float("nan"),
        bound=theory.measure(episodes, scores, driver.threshold, known, fitted.training_loss),
    )


def _losses(policy: PredictingPolicy, columns: Columns) -> NDArray[np.float32]:
    """(T,) how far each recorded proposal is from its label; 1 where it was invalid."""
    losses = np.ones(len(columns), np.float32)
    valid = columns.has_proposed
    if valid.any():
        proposed, labels = columns.proposed[valid], columns.labels[valid]
        losses[valid] = policy.surrogate_losses(Proposal(proposed), labels)
    return losses


def _looked_at(driver: Checkpoint, visited: Samples) -> tuple[NDArray, NDArray]:
    """(n,) losses and (n,) scores of states that the driver did not drive."""
    fitted = driver.fitted
    seen = look(driver.policy, visited, () if fitted.signal is None else fitted.readers)
    assert seen.losses is not None
    nothing = np.full(len(visited), np.nan)
    return seen.losses, nothing if fitted.signal is None else fitted.scores_of(seen)


def _false_alarm_rate(fitted: Checkpoint, check: Sequence[Samples]) -> float:
    """Mean share of the steps of new expert episodes below the threshold; NaN without a signal."""
    gate = fitted.fitted
    if gate.signal is None:
        return float("nan")
    alarms = [float(np.mean(~(gate.scores(one) >= gate.threshold))) for one in check]
    return float(np.mean(alarms))
