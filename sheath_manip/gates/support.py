"""SHEATH's gate: inside the support of its training states the policy acts, outside the expert."""

from collections.abc import Callable

import numpy as np

from sheath_manip.exceptions import ParameterError
from sheath_manip.types import Action, Actor, GateDecision, Observation, Reason


class SupportGate:
    """The expert takes over where the support score falls below the threshold, or there is none.

    As in the paper it hands back at the next step inside. Hysteresis (LazyDAgger), a number of
    quiet steps (RND-DAgger) and a minimum hold keep it from chattering at the boundary.
    """

    def __init__(
        self,
        score: Callable[[Observation], float | None],
        threshold: float,
        query: bool = True,
        release_margin: float = 0.0,
        quiet_steps: int = 0,
        minimum_hold_steps: int = 0,
        why: Callable[[Observation], Reason] = lambda _: Reason.OUTSIDE,
    ) -> None:
        """Store the score and how takeovers end; ParameterError for a value outside its range.

        Args:
            score: the support score of an observation, positive inside; None or NaN where there is
                none. An ArithmeticError in it counts as none.
            threshold: the score below which the expert takes over.
            query: label every state (the paper) or only those in which the expert acts.
            release_margin: >= 0, in units of the score; hand back only at threshold + margin.
            quiet_steps: the expert keeps acting for so many such steps in a row before it hands
                back.
            minimum_hold_steps: the expert acts for at least so many steps once it has taken over.
            why: what is to blame for a score below the threshold; asked only there.
        """
        if not np.isfinite(threshold):
            raise ParameterError(f"threshold is {threshold}; wanted a finite score, like 0.0")
        if not (release_margin >= 0 and quiet_steps >= 0 and minimum_hold_steps >= 0):
            raise ParameterError(
                f"release_margin is {release_margin}, quiet_steps {quiet_steps}, "
                f"minimum_hold_steps {minimum_hold_steps}; wanted each at least 0"
            )
        self.score = score
        self.threshold = threshold
        self.query = query
        self.release_margin = release_margin
        self.quiet_steps = quiet_steps
        self.minimum_hold_steps = minimum_hold_steps
        self.why = why
        self._held = 0
        self._quiet = 0

    def reset(self, rng: np.random.Generator) -> None:
        """Forget the last episode: the policy has the wheel until a score takes it away."""
        del rng
        self._held = 0
        self._quiet = 0

    def decide(self, observation: Observation, proposed: Action | None) -> GateDecision:
        """Score one observation and decide; the expert where `proposed` is None."""
        score = self._score_of(observation)
        reason = self._reason(score, proposed)
        if reason is Reason.OUTSIDE:
            reason = self.why(observation)
        if reason is Reason.INSIDE:
            self._held = self._quiet = 0
            return GateDecision(Actor.POLICY, self.query, reason, score, self.threshold)
        self._held += 1
        return GateDecision(Actor.EXPERT, True, reason, score, self.threshold)

    def _score_of(self, observation: Observation) -> float:
        try:
            score = self.score(observation)
        except ArithmeticError:
            return float("nan")
        return float("nan") if score is None else float(score)

    def _reason(self, score: float, proposed: Action | None) -> Reason:
        alarm = not score >= self.threshold
        clear = score >= self.threshold + self.release_margin
        released = self._held == 0 or (
            clear and self._quiet >= self.quiet_steps and self._held >= self.minimum_hold_steps
        )
        self._quiet = self._quiet + 1 if clear and self._held else 0
        if proposed is None:
            return Reason.INVALID_PROPOSAL
        if np.isnan(score):
            return Reason.NO_SCORE
        if alarm:
            return Reason.OUTSIDE
        return Reason.INSIDE if released else Reason.HOLD
