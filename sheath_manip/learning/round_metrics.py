"""What the episodes of a round say about the policy that drove them and the gate fitted next."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sheath_manip.learning import theory
from sheath_manip.learning.checkpoint import Checkpoint
from sheath_manip.learning.theory import Bound
from sheath_manip.types import Actor, Episode
from sheath_manip.types.samples import Samples


@dataclass(frozen=True)
class Measures:
    """Of one round; the fields are those of `RoundResult`."""

    false_alarm_rate: float
    missed_rate: float
    surrogate_loss: float
    bound: Bound


def measures_of(
    episodes: Sequence[Episode],
    visited: Samples,
    driver: Checkpoint,
    fitted: Checkpoint,
    aggregated: Samples,
    check: Sequence[Samples],
    tolerance: float = 0.0,
) -> Measures:
    """The measures of one round.

    Args:
        episodes: of the round.
        visited: all their states, labelled or not. What needs the expert's word (losses, misses)
            is measured over the labelled ones, and is NaN where there are none.
        driver: drove them.
        fitted: to the states after them.
        aggregated: the labelled states that `fitted` had, so far.
        check: new expert episodes.
        tolerance: surrogate loss up to which an action counts as the expert's.
    """
    losses = np.empty(0)
    if visited.is_labelled.any():
        losses = driver.policy.surrogate_losses(visited.labelled())
    acted = np.array([step.decision.actor is Actor.POLICY for e in episodes for step in e.steps])
    missed = acted[visited.is_labelled][losses > tolerance]
    epsilon = float(np.mean(fitted.policy.surrogate_losses(aggregated)))
    alarms = [float(np.mean(~(fitted.scores(one) >= fitted.threshold))) for one in check]
    return Measures(
        false_alarm_rate=float(np.mean(alarms)),
        missed_rate=float(missed.mean()) if len(missed) else 0.0,
        surrogate_loss=float(np.mean(losses)) if len(losses) else float("nan"),
        bound=theory.measure(episodes, driver.scores(visited), driver.threshold, losses, epsilon),
    )
