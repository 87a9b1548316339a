"""Counts what the page tells of a run: who acted how often, how episodes ended, the scores."""

from collections import Counter, deque
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

from sheath_manip.types import Actor, EpisodeInfo, GateDecision, Limited, Outcome, Reason, Step

HISTORY_STEPS = 300


class Scored(NamedTuple):
    """What the score plot shows of a step."""

    time_s: float
    score: float
    threshold: float
    expert_acts: float
    """1 or 0"""
    limited: float = 0.0
    """1 where a command filter changed the command, else 0"""


@dataclass(frozen=True)
class Share:
    """How much of the acting fell to the expert."""

    steps: int = 0
    expert_steps: int = 0
    interventions: int = 0
    """runs of consecutive expert steps while a policy is present"""
    limited_steps: int = 0
    """steps whose command a command filter changed"""

    @property
    def expert_share(self) -> float:
        """0..1, and 0 before the first step."""
        return self.expert_steps / max(self.steps, 1)

    @property
    def limited_share(self) -> float:
        """0..1, and 0 before the first step."""
        return self.limited_steps / max(self.steps, 1)

    def after(self, expert_acts: bool, intervention_begins: bool, limited: bool) -> "Share":
        """Return the counts with one more step."""
        return Share(
            self.steps + 1,
            self.expert_steps + expert_acts,
            self.interventions + intervention_begins,
            self.limited_steps + limited,
        )


@dataclass(frozen=True)
class Figures:
    """The counts at one moment; a series is all episodes of one method and purpose."""

    info: EpisodeInfo
    episode: Share = Share()
    series: Share = Share()
    outcomes: Mapping[Outcome, int] | None = None
    """of the episodes of the series that have ended"""
    decision: GateDecision | None = None
    """the latest of this episode"""
    limited: tuple[Limited, ...] = ()
    """what the command filter changed in that step"""
    outcome: Outcome | None = None
    """of this episode, once it has ended"""


class Tally:
    """Follows the steps of one episode after the other; every call is cheap."""

    def __init__(self) -> None:
        self.scores: deque[Scored] = deque(maxlen=HISTORY_STEPS)
        """of the latest steps"""
        self._figures: Figures | None = None
        self._shares: dict[tuple[str, str], Share] = {}
        self._outcomes: dict[tuple[str, str], Counter[Outcome]] = {}
        self._expert_acted = False

    @property
    def figures(self) -> Figures | None:
        """The counts now, or None before the first episode."""
        return self._figures

    def start(self, info: EpisodeInfo) -> None:
        """Begin the episode of `info`."""
        series = (info.method, info.purpose)
        self.scores.clear()
        self._expert_acted = False
        self._figures = Figures(
            info,
            series=self._shares.get(series, Share()),
            outcomes=dict(self._outcomes.get(series, {})),
        )

    def step(self, step: Step) -> None:
        """Count one step."""
        figures = self._started()
        decision = step.decision
        expert_acts = decision.actor is Actor.EXPERT
        # An invalid proposal is stored as none at all, though a policy made it.
        has_policy = step.proposed is not None or decision.reason is Reason.INVALID_PROPOSAL
        begins = expert_acts and has_policy and not self._expert_acted
        self._expert_acted = expert_acts
        limited = bool(step.limited)
        self.scores.append(
            Scored(
                step.observation.time_s,
                decision.score,
                decision.threshold,
                float(expert_acts),
                float(limited),
            )
        )
        self._figures = replace(
            figures,
            episode=figures.episode.after(expert_acts, begins, limited),
            series=figures.series.after(expert_acts, begins, limited),
            decision=decision,
            limited=step.limited,
        )

    def end(self, outcome: Outcome) -> None:
        """Count how the episode ended."""
        figures = self._started()
        series = (figures.info.method, figures.info.purpose)
        self._shares[series] = figures.series
        self._outcomes.setdefault(series, Counter())[outcome] += 1
        self._figures = replace(figures, outcomes=dict(self._outcomes[series]), outcome=outcome)

    def _started(self) -> Figures:
        assert self._figures is not None, "on_start comes before on_step and on_end"
        return self._figures
