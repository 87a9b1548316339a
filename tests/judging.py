"""Who judges, for tests of what is made of judgements."""

from collections.abc import Callable
from dataclasses import dataclass

from sheath_manip.policies.looking import seen_in
from sheath_manip.protocols import Signal, TrainablePolicy
from sheath_manip.types import Judgement, Observation, Proposal, Reason


@dataclass(frozen=True)
class ByObservation:
    """Scores the state alone, as a function of what is observed there says."""

    score: Callable[[Observation], float]
    blames: Reason = Reason.OUTSIDE

    def judge(self, observation: Observation, proposal: Proposal) -> Judgement:
        del proposal
        return Judgement(self.score(observation), self.blames)


def always(score: float, blames: Reason = Reason.OUTSIDE) -> ByObservation:
    return ByObservation(lambda _: score, blames)


@dataclass(frozen=True)
class BySignal:
    """Scores by a signal that was fitted to looks of the policy."""

    signal: Signal
    policy: TrainablePolicy

    def judge(self, observation: Observation, proposal: Proposal) -> Judgement:
        readers = self.signal.attach(self.policy)
        measures = self.signal.measure(seen_in(observation, proposal, readers))
        return Judgement(float(self.signal.scores(measures)[0]), self.signal.blames(measures[0]))
