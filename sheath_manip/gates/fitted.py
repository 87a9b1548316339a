"""What a gate knows once it is fitted: enough to judge a proposal, and to be saved."""

from dataclasses import dataclass, field
from functools import cached_property
from math import isnan

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError
from sheath_manip.gates.config import GateConfig
from sheath_manip.gates.held_out import HeldOut
from sheath_manip.gates.progress import Progress
from sheath_manip.policies.looking import look, seen_in
from sheath_manip.protocols import HasParts, PredictingPolicy, Reader, Signal
from sheath_manip.types import Judgement, Observation, Proposal, Reason, SignalScore
from sheath_manip.types.samples import Samples
from sheath_manip.types.seen import Seen


@dataclass(frozen=True)
class Sources:
    """The names of the episodes that something was fitted to, and of those that were held out."""

    fitted_to: tuple[str, ...] = ()
    held_out: tuple[str, ...] = ()
    """expert episodes that no fit has seen, for the threshold"""


@dataclass(frozen=True, eq=False)
class FittedGate:
    """Settings, signal and threshold. The signal is shared, not copied: a later fit changes it."""

    config: GateConfig
    policy: PredictingPolicy
    """whose looks the signal judges"""
    signal: Signal | None = None
    """None where nothing reads one: the gate then goes by a schedule, or by a person"""
    threshold: float = float("nan")
    """the score below which the expert takes over"""
    release_margin: float = 0.0
    """>= 0, how far above the threshold a score must be for the expert to hand back, as it was
    calibrated; what the settings ask for comes on top"""
    sources: Sources = field(default_factory=Sources)
    progress: Progress | None = None
    """how little the expert moves within a while; None where nobody asks for it"""
    held_out: HeldOut = field(default_factory=HeldOut)
    """how the held-out expert episodes score; empty where older versions fitted it"""

    @cached_property
    def readers(self) -> tuple[Reader, ...]:
        """What the signal takes of each look; asked once, since each step asks again."""
        return self.fitted_signal.attach(self.policy)

    @property
    def fitted_signal(self) -> Signal:
        """The signal; raises ParameterError where there is none."""
        if self.signal is None:
            raise ParameterError(
                f"a gate of kind {self.config.kind!r} looks at no signal, so none was fitted; "
                "wanted a checkpoint of a method such as sheath, or the policy alone"
            )
        return self.signal

    def judge(self, observation: Observation, proposal: Proposal, threshold: float) -> Judgement:
        """Score the proposal in its state; nothing is asked of the policy again."""
        signal = self.fitted_signal
        measures = signal.measure(seen_in(observation, proposal, self.readers))
        score = float(signal.scores(measures)[0])
        # What is to blame takes as long as the score, and is of no interest above the threshold.
        blames = Reason.OUTSIDE if score >= threshold else signal.blames(measures[0])
        return Judgement(score, blames, self._signal_scores(measures[0], score))

    def _signal_scores(self, measures: NDArray, score: float) -> tuple[SignalScore, ...]:
        """What the score is made of: no more than the numbers that were there already."""
        if self._parts is not None:
            return self._parts.signal_scores(measures)
        if isnan(score):
            return ()
        return (SignalScore(self.config.signal, score, self.held_out.share(score)),)

    @cached_property
    def _parts(self) -> HasParts | None:
        """The signal where it has parts: to ask a protocol takes longer than the scores do."""
        return self.signal if isinstance(self.signal, HasParts) else None

    def scores_of(self, seen: Seen) -> NDArray[np.float64]:
        """(n,) the scores of states as the policy saw them."""
        signal = self.fitted_signal
        return signal.scores(signal.measure(seen))

    def scores(self, samples: Samples) -> NDArray[np.float64]:
        """(n,) the scores of `samples`, which the policy looks at for this."""
        return self.scores_of(look(self.policy, samples, self.readers))
