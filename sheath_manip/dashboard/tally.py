"""Counts what the page tells of a run: who acted how often, and how episodes ended."""

from collections import Counter
from collections.abc import Mapping

from sheath_manip.burden import StepCounts
from sheath_manip.playback.trace import Trace
from sheath_manip.types import EpisodeInfo, Outcome
from sheath_manip.types.columns import IN_PLACE_OF_POLICY


def counts_of_trace(trace: Trace, control_rate_hz: float) -> StepCounts:
    """Return what is counted of one episode, as far as it is known."""
    driving = IN_PLACE_OF_POLICY[trace.actor]
    return StepCounts(
        episodes=1,
        steps=len(trace),
        driving_steps=int(driving.sum()),
        active_s=float((driving | trace.by_policy).sum()) / control_rate_hz,
        driving_s=float(driving.sum()) / control_rate_hz,
        takeovers=len(trace.turns),
        labels=int(trace.query.sum()),
        limited_steps=int(trace.limited.sum()),
    )


class Tally:
    """Adds up episodes; a series is all of one method and purpose."""

    def __init__(self) -> None:
        self._counts: dict[tuple[str, str], StepCounts] = {}
        self._outcomes: dict[tuple[str, str], Counter[Outcome]] = {}

    def end(self, info: EpisodeInfo, counts: StepCounts, outcome: Outcome) -> None:
        """Count an episode that has ended."""
        self._counts[_series(info)] = self.counts(info) + counts
        self._outcomes.setdefault(_series(info), Counter())[outcome] += 1

    def counts(self, info: EpisodeInfo) -> StepCounts:
        """Return what is counted of the series' episodes that have ended."""
        return self._counts.get(_series(info), StepCounts())

    def outcomes(self, info: EpisodeInfo) -> Mapping[Outcome, int]:
        """Return the outcomes of the series' episodes that have ended."""
        return dict(self._outcomes.get(_series(info), {}))


def _series(info: EpisodeInfo) -> tuple[str, str]:
    return info.method, info.purpose
