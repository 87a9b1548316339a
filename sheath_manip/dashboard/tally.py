"""Counts what the page tells of a run: who acted how often, and how episodes ended."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, fields

import numpy as np

from sheath_manip.playback.trace import Trace
from sheath_manip.types import EpisodeInfo, Outcome
from sheath_manip.types.columns import IN_PLACE_OF_POLICY


@dataclass(frozen=True)
class Share:
    """The share: how much of the acting fell to the expert."""

    steps: int = 0
    expert_steps: int = 0
    interventions: int = 0
    """runs of steps in which somebody else than the policy acts, though there is one"""
    switches: int = 0
    """changes of who acts"""
    queries: int = 0
    """steps with a label"""
    limited_steps: int = 0
    """steps whose command a command filter changed"""

    @classmethod
    def of(cls, trace: Trace) -> "Share":
        """The counts of one episode."""
        return cls(
            len(trace),
            int(np.isin(trace.actor, IN_PLACE_OF_POLICY).sum()),
            len(trace.turns),
            int(np.count_nonzero(np.diff(trace.by_policy))),
            int(trace.query.sum()),
            int(trace.limited.sum()),
        )

    def __add__(self, other: "Share") -> "Share":
        return Share(*(getattr(self, f.name) + getattr(other, f.name) for f in fields(Share)))

    @property
    def expert_share(self) -> float:
        """0..1, and 0 before the first step."""
        return self.expert_steps / max(self.steps, 1)

    @property
    def limited_share(self) -> float:
        """0..1, and 0 before the first step."""
        return self.limited_steps / max(self.steps, 1)


class Tally:
    """Adds up episodes; a series is all of one method and purpose."""

    def __init__(self) -> None:
        self._shares: dict[tuple[str, str], Share] = {}
        self._outcomes: dict[tuple[str, str], Counter[Outcome]] = {}

    def end(self, info: EpisodeInfo, share: Share, outcome: Outcome) -> None:
        """Count an episode that has ended."""
        self._shares[_series(info)] = self.share(info) + share
        self._outcomes.setdefault(_series(info), Counter())[outcome] += 1

    def share(self, info: EpisodeInfo) -> Share:
        """Return the share of the series' episodes that have ended."""
        return self._shares.get(_series(info), Share())

    def outcomes(self, info: EpisodeInfo) -> Mapping[Outcome, int]:
        """Return the outcomes of the series' episodes that have ended."""
        return dict(self._outcomes.get(_series(info), {}))


def _series(info: EpisodeInfo) -> tuple[str, str]:
    return info.method, info.purpose
