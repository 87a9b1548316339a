"""What is asked of the expert: takeovers, seconds of driving and labels, each counted apart.

The one definition for results, tables, figures, verbs and the page. A takeover is an intervention,
a run of steps in which somebody else than the policy acts, in an episode that has a policy.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Self

import numpy as np

from sheath_manip.metrics import EpisodeRecord

MINUTE_S = 60.0


@dataclass(frozen=True)
class StepCounts:
    """What is counted of the steps of episodes; counts of several episodes add up."""

    episodes: int = 0
    steps: int = 0
    driving_steps: int = 0
    """driven in the policy's place: by the expert, an operator or a fallback controller"""
    active_s: float = 0.0
    """time in which somebody drove, the policy included: while the robot is held and waits for a
    person, none passes; NaN where the control rate is not known"""
    driving_s: float = 0.0
    """time of the driving steps"""
    takeovers: int = 0
    labels: int = 0
    """steps with a label, whether the expert acted or was only asked"""
    limited_steps: int = 0
    """steps whose command a command filter changed"""

    def __add__(self, other: "StepCounts") -> "StepCounts":
        names = [each.name for each in fields(StepCounts)]
        return StepCounts(**{name: getattr(self, name) + getattr(other, name) for name in names})

    @property
    def expert_share(self) -> float:
        """Share of the steps that were driven in the policy's place; 0 before the first step."""
        return self.driving_steps / max(self.steps, 1)

    @property
    def limited_share(self) -> float:
        """Share of the steps whose command was changed; 0 before the first step."""
        return self.limited_steps / max(self.steps, 1)

    @property
    def takeovers_an_episode(self) -> float:
        """Takeovers an episode; NaN without an episode."""
        return _each(self.takeovers, self.episodes)

    @property
    def takeovers_a_minute(self) -> float:
        """Takeovers a minute in which somebody drove; NaN before the first step."""
        return _each(MINUTE_S * self.takeovers, self.active_s)

    @property
    def driving_s_an_episode(self) -> float:
        """Seconds of driving an episode; NaN without an episode."""
        return _each(self.driving_s, self.episodes)

    @property
    def labels_an_episode(self) -> float:
        """Labels an episode; NaN without an episode."""
        return _each(self.labels, self.episodes)


@dataclass(frozen=True)
class Burden:
    """What a set of episodes asked of the expert; NaN where it cannot be said."""

    takeovers_an_episode: float
    takeovers_a_minute: float
    median_takeover_s: float
    """seconds that somebody drove in a takeover, of all takeovers the median"""
    driving_s_an_episode: float
    labels_an_episode: float

    @classmethod
    def of(cls, counts: StepCounts, turns_s: Sequence[float]) -> Self:
        """Return it for what was counted, and the seconds of each takeover."""
        return cls(
            takeovers_an_episode=counts.takeovers_an_episode,
            takeovers_a_minute=counts.takeovers_a_minute,
            median_takeover_s=float(np.median(turns_s)) if len(turns_s) else float("nan"),
            driving_s_an_episode=counts.driving_s_an_episode,
            labels_an_episode=counts.labels_an_episode,
        )


def counts_of(record: EpisodeRecord) -> StepCounts:
    """Return what is counted of one episode."""
    rate_hz = record.control_rate_hz
    return StepCounts(
        episodes=1,
        steps=record.steps,
        driving_steps=record.expert_steps,
        active_s=(record.steps - record.hold_steps) / rate_hz,
        driving_s=record.expert_steps / rate_hz,
        takeovers=record.interventions,
        labels=record.queries,
        limited_steps=record.limited_steps,
    )


def burden_of(records: Sequence[EpisodeRecord]) -> Burden:
    """Return what the episodes of `records` asked of the expert."""
    turns_s = [steps / each.control_rate_hz for each in records for steps in each.turns]
    return Burden.of(sum(map(counts_of, records), StepCounts()), turns_s)


def _each(amount: float, count: float) -> float:
    return amount / count if count else float("nan")
