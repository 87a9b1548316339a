"""Who judges, for tests of what is made of judgements."""

from collections.abc import Callable
from dataclasses import dataclass

from sheath_manip.types import Judgement, Observation, Proposal, Reason


@dataclass(frozen=True)
class ByObservation:
    """Scores the state alone, as a function of what is observed there says."""

    score: Callable[[Observation], float]
    blames: Reason = Reason.OUTSIDE

    def judge(self, observation: Observation, proposal: Proposal, threshold: float) -> Judgement:
        del proposal, threshold
        return Judgement(self.score(observation), self.blames)


def always(score: float, blames: Reason = Reason.OUTSIDE) -> ByObservation:
    return ByObservation(lambda _: score, blames)
