"""SHEATH's gate: inside the support of its training states the policy acts, outside the expert."""

from dataclasses import replace

import numpy as np

from sheath_manip.exceptions import ParameterError
from sheath_manip.protocols import Judge
from sheath_manip.types import Actor, GateDecision, Judgement, Observation, Proposal, Reason

NO_SCORE = Judgement(float("nan"), Reason.NO_SCORE)


class SupportGate:
    """The expert takes over where the support score falls below the threshold, or there is none.

    As in the paper it hands back at the next step inside. Hysteresis (LazyDAgger), a number of
    quiet steps (RND-DAgger) and a minimum hold keep it from chattering at the boundary.
    """

    def __init__(
        self,
        judge: Judge,
        threshold: float,
        query: bool = True,
        release_margin: float = 0.0,
        quiet_steps: int = 0,
        minimum_hold_steps: int = 0,
    ) -> None:
        """Store who judges and how takeovers end; ParameterError for a value outside its range.

        Args:
            judge: scores a proposal in its state, the higher the safer; NaN where there is no
                score. An ArithmeticError in it counts as none.
            threshold: the score below which the expert takes over.
            query: label every state (the paper) or only those in which the expert acts.
            release_margin: >= 0, in units of the score; hand back only at threshold + margin.
            quiet_steps: the expert keeps acting for so many such steps in a row before it hands
                back.
            minimum_hold_steps: the expert acts for at least so many steps once it has taken over.
        """
        if not np.isfinite(threshold):
            raise ParameterError(f"threshold is {threshold}; wanted a finite score, like 0.0")
        if not (release_margin >= 0 and quiet_steps >= 0 and minimum_hold_steps >= 0):
            raise ParameterError(
                f"release_margin is {release_margin}, quiet_steps {quiet_steps}, "
                f"minimum_hold_steps {minimum_hold_steps}; wanted each at least 0"
            )
        self.judge = judge
        self.threshold = threshold
        self.query = query
        self.release_margin = release_margin
        self.quiet_steps = quiet_steps
        self.minimum_hold_steps = minimum_hold_steps
        self._held = 0
        self._quiet = 0

    def reset(self, rng: np.random.Generator) -> None:
        """Forget the last episode: the policy has the wheel until a score takes it away."""
        del rng
        self._held = 0
        self._quiet = 0

    def decide(self, observation: Observation, proposal: Proposal | None) -> GateDecision:
        """Judge the proposal and decide; the expert where there is none.

        Raises ParameterError where what judges gives no `Judgement`.
        """
        if proposal is None:
            judgement = Judgement(float("nan"), Reason.INVALID_PROPOSAL)
        else:
            judgement = self._judged(observation, proposal)
        reason = self._reason(judgement)
        if reason is Reason.INSIDE:
            self._held = self._quiet = 0
            return self._decided(Actor.POLICY, self.query, reason, judgement)
        self._held += 1
        return self._decided(Actor.EXPERT, True, reason, judgement)

    def _decided(
        self, actor: Actor, query: bool, reason: Reason, judgement: Judgement
    ) -> GateDecision:
        score, signals = judgement.score, judgement.signals
        return GateDecision(actor, query, reason, score, self.threshold, signals=signals)

    def _judged(self, observation: Observation, proposal: Proposal) -> Judgement:
        try:
            judgement = self.judge.judge(observation, proposal, self.threshold)
        except ArithmeticError:
            return NO_SCORE
        if not isinstance(judgement, Judgement):
            raise ParameterError(
                f"judge gave a {type(judgement).__name__}; wanted a Judgement, such as "
                "Judgement(0.3)"
            )
        if np.isnan(judgement.score):
            return replace(NO_SCORE, signals=judgement.signals)
        return judgement

    def _reason(self, judgement: Judgement) -> Reason:
        score = judgement.score
        alarm = not score >= self.threshold
        clear = score >= self.threshold + self.release_margin
        released = self._held == 0 or (
            clear and self._quiet >= self.quiet_steps and self._held >= self.minimum_hold_steps
        )
        self._quiet = self._quiet + 1 if clear and self._held else 0
        if alarm:
            return judgement.blames
        return Reason.INSIDE if released else Reason.HOLD
