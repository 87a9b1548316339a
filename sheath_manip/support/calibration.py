"""The gate's threshold: from a rate of false alarms, or from how much the expert may work.

The first two look at expert episodes that neither policy nor support was fitted to. Once calibrated
on them a threshold may stay while the support is refitted less and less (CRSAIL, 2025), or be found
again each round; a budget, which looks at what the policy visits, must be found again each round.
"""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError, UnscoredError
from sheath_manip.support.config import ThresholdConfig
from sheath_manip.support.reach import warn_out_of_reach

# One lap calibrates badly (.84-.99 of a new lap inside), three pooled ones well (.94-.96).
LEAST_EPISODES = 3
REJECT_ALL = float(np.finfo(np.float32).max)
"""a threshold that no score reaches: the expert acts everywhere"""


def or_reject_all(threshold: Callable[[], float]) -> float:
    """Return the threshold, or `REJECT_ALL` where too many states have no score."""
    try:
        return threshold()
    except UnscoredError:
        return REJECT_ALL


def held_out_threshold(
    scores_by_episode: Sequence[NDArray], false_alarm_rate: float, far_score: float = -np.inf
) -> float:
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
        far_score: the score infinitely far from all training states, such as `far_score` of a
            one-class SVM: with it a GateWarning tells where the threshold lies so low that hardly
            any state scores below it.

    Raises:
        ParameterError: too few episodes or steps for the rate, or a rate outside its range;
            UnscoredError among them where too many steps have no score.
    """
    _check_between("false_alarm_rate", false_alarm_rate)
    episodes = _scored(scores_by_episode)
    if len(episodes) < LEAST_EPISODES:
        raise ParameterError(
            f"{len(episodes)} held-out episodes with scores cannot calibrate a threshold; "
            f"wanted at least {LEAST_EPISODES}"
        )
    scores = np.concatenate(episodes)
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
        raise _fault(missing)(
            f"{steps} held-out steps, {missing} of them without a score, cannot hold a false-alarm "
            f"rate of {false_alarm_rate}; wanted at least {int(np.ceil(1 / false_alarm_rate))} "
            "with scores"
        )
    warn_out_of_reach(threshold, far_score, len(episodes))
    return threshold


def episode_threshold(scores_by_episode: Sequence[NDArray], alarm_probability: float) -> float:
    """The threshold at which a new expert episode alarms ANYWHERE with at most this probability.

    Split conformal prediction on the lowest score of each episode (Vovk, Gammerman & Shafer 2005,
    'Algorithmic learning in a random world'): of K minima the floor(alarm_probability * (K + 1))-th
    lowest. An episode alarms where a score is below the threshold or NaN.

    What is promised: if the episodes are exchangeable with the new one, the probability over all of
    them. Steps within an episode may depend on each other as they like. What is not: see
    `held_out_threshold`.

    Args:
        scores_by_episode: K >= 1 / alarm_probability - 1 arrays of support scores, (n_k,) each.
        alarm_probability: between 0 and 1, both excluded.

    Raises:
        ParameterError: too few episodes for the probability, or one outside its range;
            UnscoredError among them where too many have a step without a score.
    """
    _check_between("alarm_probability", alarm_probability)
    minima = np.sort([scores.min() for scores in _scored(scores_by_episode)])
    # 0.1 * (9 + 1) is a little above or below 1 by rounding.
    rank = int(np.floor(alarm_probability * (len(minima) + 1) + 1e-9))
    if rank == 0 or minima[rank - 1] == -np.inf:
        missing = int(np.isneginf(minima).sum())
        wanted = int(np.ceil((missing + 1) / alarm_probability - 1e-9)) - 1
        raise _fault(missing)(
            f"{len(minima)} held-out episodes, {missing} of them with a step without a score, "
            f"cannot hold an alarm probability of {alarm_probability}; wanted at least {wanted}"
        )
    return float(minima[rank - 1])


def budget_threshold(scores: NDArray, expert_share: float) -> float:
    """The threshold at which the expert gets the asked share of the steps that gave `scores`.

    ThriftyDAgger's budget (Hoque et al. 2021): the `expert_share`-quantile of the scores of the
    policy's own steps in the last rounds. A step goes to the expert where its score is below the
    threshold; a score of NaN does always.

    The share holds for those steps. Once the expert takes over, and once the policy is refitted,
    other states are visited: find the threshold again each round.

    Args:
        scores: (n,) support scores, n >= 1 / expert_share.
        expert_share: between 0 and 1, both excluded.

    Raises:
        ParameterError: too few scores for the share, or a share outside its range; UnscoredError
            among them where too many steps have none.
    """
    _check_between("expert_share", expert_share)
    ordered = np.sort(np.concatenate([np.empty(0), *_scored([scores])]))
    below = int(np.floor(expert_share * len(ordered) + 1e-9))
    if below == 0 or ordered[below] == -np.inf:
        missing = int(np.isneginf(ordered).sum())
        raise _fault(missing)(
            f"{len(ordered)} steps, {missing} of them without a score, cannot hold an expert share "
            f"of {expert_share}; wanted at least {int(np.ceil(1 / expert_share))} and a share of "
            f"at least that without one"
        )
    return float(ordered[below])


def level_threshold(scores_by_episode: Sequence[NDArray], level: float) -> float:
    """The threshold of a level, which goes on below the lowest score that the expert has.

    From 0 on it is the score below which so large a share of the expert's held-out steps lies, 0
    the lowest; below 0 it lies so many times farther below the lowest as the lowest is below the
    median. So a gate can be stricter than any rate of false alarms says: it asks a few times in ten
    episodes, not in each.

    Nothing is promised of new expert steps.

    Args:
        scores_by_episode: arrays of support scores, (n_k,) each.
        level: below 1; -1 is twice as far below the median as the lowest.

    Raises:
        ParameterError: another level; UnscoredError among them where no step has a score.
    """
    if not level < 1:
        raise ParameterError(f"level is {level}; wanted less than 1, like -0.5 or 0.01")
    scores = np.concatenate([np.empty(0), *_scored(scores_by_episode)])
    known = scores[np.isfinite(scores)]
    if not len(known):
        raise UnscoredError(
            f"none of {len(scores)} held-out steps has a score; wanted one at least"
        )
    lowest, middle = float(known.min()), float(np.median(known))
    if level <= 0:
        return lowest + level * max(middle - lowest, 1e-9)
    return float(np.quantile(known, level))


ThresholdRule = Callable[[Sequence[NDArray], Sequence[NDArray], ThresholdConfig], float]
"""from the scores of held-out expert episodes and of what the policy met last, and the config"""

THRESHOLD_RULES: dict[str, ThresholdRule] = {
    "steps": lambda held_out, _, config: held_out_threshold(held_out, config.false_alarm_rate),
    "episodes": lambda held_out, _, config: episode_threshold(held_out, config.false_alarm_rate),
    "level": lambda held_out, _, config: level_threshold(held_out, config.level),
    "boundary": lambda *_: 0.0,
    "budget": lambda _, met, config: budget_threshold(np.concatenate(met), config.expert_budget),
}
"""by the names of `support.config.RULES`"""


def planned_threshold(
    held_out: Sequence[NDArray], met: Sequence[NDArray], config: ThresholdConfig
) -> float:
    """The threshold that `config` asks for, or one that fails safe where none will do.

    Args:
        held_out: scores of held-out expert episodes, (n_k,) each.
        met: scores of what the policy met last, (n_k,) each.
        config: rule and rate.
    """
    rule = THRESHOLD_RULES[config.rule]
    return or_reject_all(lambda: rule(held_out, met, config))


def _check_between(name: str, value: float) -> None:
    if not 0 < value < 1:
        raise ParameterError(f"{name} is {value}; wanted a share between 0 and 1, like 0.05")


def _fault(missing: int) -> type[ParameterError]:
    """UnscoredError where scores are missing, not steps or episodes."""
    return UnscoredError if missing else ParameterError


def _scored(scores_by_episode: Sequence[NDArray]) -> list[NDArray[np.float64]]:
    """Those with steps, as copies with -inf, an alarm under any threshold, for what is missing."""
    episodes = [np.array(scores, dtype=np.float64).ravel() for scores in scores_by_episode]
    for scores in episodes:
        scores[np.isnan(scores)] = -np.inf
    return [scores for scores in episodes if len(scores)]
