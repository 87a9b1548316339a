"""What a gate would have done with another threshold, told from recorded scores alone.

Nothing is run again, so what a preview says of the steps after the first that would have gone
otherwise is an estimate: in truth the robot would have been elsewhere by then.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sheath_manip.gates.patient import MINUTE_S, ROUNDING_S


@dataclass(frozen=True)
class TurnRule:
    """When the expert takes over and hands back, as `SupportGate` and those around it do."""

    threshold: float
    """the score below which the expert takes over; no score is below any"""
    minimum_hold_steps: int = 0
    release_margin: float = 0.0
    quiet_steps: int = 0
    a_minute: int = 0
    """requests in any 60 s, at most, since after the last the expert drives on; 0: no limit"""
    dose_every_steps: int = 0
    """steps from one of the expert's to its next while it alarms; 0: it acts in all"""


@dataclass(frozen=True, eq=False)
class ScoredEpisode:
    """The recorded scores of one episode."""

    scores: NDArray[np.float64]
    """(T,) NaN where there is none"""
    failed: bool
    """whether the task ended it as failed: with its last step"""
    ended: bool = True
    """False: it still runs, and is neither a failure nor none"""


@dataclass(frozen=True)
class Preview:
    """What a rule would come to."""

    steps: int
    """that were looked at"""
    expert_share: float
    """0..1 of them, in which the expert would have acted; NaN without a step"""
    requests_a_minute: float
    """of driven time; NaN without a step"""
    false_alarm_share: float
    """0..1 of held-out expert steps below the threshold; NaN where none are known"""
    false_alarm_episodes: tuple[int, int]
    """held-out expert episodes with an alarm, and how many there are"""
    foreseen: tuple[int, int]
    """failed episodes in which the expert would have been asked before the last step, and all"""
    needless: tuple[int, int]
    """the other episodes in which it would have been asked, and all of those"""
    first_request: tuple[int | None, ...]
    """of each episode: the first step of the expert; None where it is never asked"""


def expert_turns(
    scores: NDArray[np.float64], rule: TurnRule, control_rate_hz: float
) -> NDArray[np.bool_]:
    """(T,) in which steps the expert would act, where the gate judged by (T,) recorded `scores`."""
    turns = np.zeros(len(scores), bool)
    release, held, quiet = rule.threshold + rule.release_margin, 0, 0
    for step, score in enumerate(scores.tolist()):
        clear = score >= release
        ripe = clear and quiet >= rule.quiet_steps and held >= rule.minimum_hold_steps
        quiet = quiet + 1 if clear and held else 0
        if score >= rule.threshold and (held == 0 or ripe):
            held = quiet = 0
        else:
            held += 1
            turns[step] = True
    if rule.dose_every_steps:
        turns = _dosed(turns, scores, rule.dose_every_steps)
    return _spared(turns, rule.a_minute, control_rate_hz) if rule.a_minute else turns


def preview(
    episodes: Sequence[ScoredEpisode],
    held_out: Sequence[NDArray[np.float64]],
    rule: TurnRule,
    control_rate_hz: float,
) -> Preview:
    """Return what `rule` would have come to in recorded `episodes`, and on `held_out` scores."""
    turns = [expert_turns(each.scores, rule, control_rate_hz) for each in episodes]
    steps = sum(map(len, turns))
    requests = sum(int(_starts(each).sum()) for each in turns)
    minutes = steps / control_rate_hz / MINUTE_S
    alarms = [~(scores >= rule.threshold) for scores in held_out]
    expert = np.concatenate([np.zeros(0, bool), *alarms])
    failed = [bool(each[:-1].any()) for each, of in zip(turns, episodes, strict=True) if of.failed]
    others = [
        bool(each.any())
        for each, of in zip(turns, episodes, strict=True)
        if of.ended and not of.failed
    ]
    return Preview(
        steps=steps,
        expert_share=sum(int(each.sum()) for each in turns) / steps if steps else np.nan,
        requests_a_minute=requests / minutes if steps else np.nan,
        false_alarm_share=float(expert.mean()) if expert.size else np.nan,
        false_alarm_episodes=(sum(bool(each.any()) for each in alarms), len(alarms)),
        foreseen=(sum(failed), len(failed)),
        needless=(sum(others), len(others)),
        first_request=tuple(int(each.argmax()) if each.any() else None for each in turns),
    )


def _dosed(
    turns: NDArray[np.bool_], scores: NDArray[np.float64], every_steps: int
) -> NDArray[np.bool_]:
    """One of so many of the turns' steps, as `DosedGate` has it, and all that have no score."""
    doses, due = np.zeros(len(turns), bool), 0
    for step in np.flatnonzero(turns):
        if step >= due or np.isnan(scores[step]):
            doses[step], due = True, step + every_steps
    return doses


def _spared(turns: NDArray[np.bool_], a_minute: int, control_rate_hz: float) -> NDArray[np.bool_]:
    """The turns of a gate that hands back only where another request may come at once."""
    longer, requests, driving = turns.copy(), list[int](), False
    for step, wanted in enumerate(turns.tolist()):
        if wanted:
            if not driving:
                requests.append(step)
            driving = True
        elif driving:
            minute = (MINUTE_S - ROUNDING_S) * control_rate_hz
            driving = sum(step - at < minute for at in requests) >= a_minute
            longer[step] = driving
    return longer


def _starts(turns: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """(T,) which steps begin a turn of the expert."""
    return turns & ~np.concatenate([[False], turns[:-1]])
