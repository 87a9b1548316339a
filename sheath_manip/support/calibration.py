"""The gate's threshold, from expert episodes that neither policy nor support was fitted to."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError

# One lap calibrates badly (.84-.99 of a new lap inside), three pooled ones well (.94-.96).
LEAST_EPISODES = 3


def held_out_threshold(scores_by_episode: Sequence[NDArray], false_alarm_rate: float) -> float:
    """The threshold below which a new expert step falls at the asked rate.

    The `false_alarm_rate`-quantile of the held-out steps' scores with each episode weighted alike,
    and with the conformal correction for a finite sample: one step more, worse than all, is counted
    in. A step alarms where its score is below the threshold; a score of NaN alarms always.

    What is promised: if the N steps of K held-out episodes are exchangeable with those of the new
    one, the expected share of alarms in it is at most the asked rate. If only the episodes are
    exchangeable, while the steps within one resemble each other, it is at most
    (rate * K + 1) / (K + 1) (Dunn, Wasserman & Ramdas 2022, 'Distribution-free prediction sets for
    two-layer hierarchical models'), and near the rate where the episodes are alike.
    What is not: anything about misses, states that the policy cannot handle and that score above
    the threshold; nor about states that a changing policy visits, which are not the expert's.

    Args:
        scores_by_episode: K >= 3 arrays of support scores, (n_k,) each with n_k >= 1.
        false_alarm_rate: between 0 and 1, both excluded.

    Raises:
        ParameterError: too few episodes or steps for the rate, or a rate outside its range.
    """
    if not 0 < false_alarm_rate < 1:
        raise ParameterError(
            f"false_alarm_rate is {false_alarm_rate}; wanted a share between 0 and 1, like 0.05"
        )
    episodes = [np.asarray(scores, dtype=np.float64).ravel() for scores in scores_by_episode]
    episodes = [scores for scores in episodes if len(scores)]
    if len(episodes) < LEAST_EPISODES:
        raise ParameterError(
            f"{len(episodes)} held-out episodes with scores cannot calibrate a threshold; "
            f"wanted at least {LEAST_EPISODES}"
        )
    scores = np.concatenate(episodes)
    scores[np.isnan(scores)] = -np.inf
    steps = len(scores)
    weights = np.concatenate(
        [
            np.full(len(episode), steps / (steps + 1) / len(episodes) / len(episode))
            for episode in episodes
        ]
    )
    order = np.argsort(scores)
    # The mass at or below each score, that of the one step more (1 / (steps + 1)) among it.
    mass = 1 / (steps + 1) + np.cumsum(weights[order])
    threshold = float(
        scores[order][min(int(np.searchsorted(mass, false_alarm_rate, "right")), steps - 1)]
    )
    if 1 / (steps + 1) > false_alarm_rate or threshold == -np.inf:
        missing = int(np.isneginf(scores).sum())
        raise ParameterError(
            f"{steps} held-out steps, {missing} of them without a score, cannot hold a false-alarm "
            f"rate of {false_alarm_rate}; wanted at least {int(np.ceil(1 / false_alarm_rate))} "
            "with scores"
        )
    return threshold
