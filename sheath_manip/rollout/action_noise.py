"""DART: the expert's actions are executed with noise and labelled without it.

Laskey et al. 2017, 'DART: Noise injection for robust imitation learning' (CoRL): the expert's
action is executed with noise and labelled without, so that the demonstrations show the way back
from where a policy's own errors will lead. In the one loop this is a policy, under a gate that asks
for a label at every step.
"""

import numpy as np

from sheath_manip.exceptions import ParameterError
from sheath_manip.protocols import Expert
from sheath_manip.types import ActionSpec, Observation, Observations, Proposal

CORRELATION_STEPS = 5.0
"""after which a push has fallen to 1/e: a push that changes its mind at each step leads nowhere"""


class DisturbedExpert:
    """Proposes the expert's action and a Gaussian push, which fades and is renewed step by step."""

    def __init__(self, expert: Expert, action: ActionSpec, noise: float) -> None:
        """Store what is disturbed and how much; ParameterError for a negative noise.

        Args:
            expert: asked at every step, so it must not mind to be asked again for the label.
            action: whose bounds hold for the sum too.
            noise: standard deviation of the push, as a share of half the range of each dimension.
        """
        if noise < 0:
            raise ParameterError(f"noise is {noise}; wanted a share of the actions' range, like .3")
        self.expert = expert
        self.action = action
        self.noise = noise
        self._rng = np.random.default_rng(0)
        self._push = np.zeros(len(action.names))

    def reset(self, rng: np.random.Generator) -> None:
        """Begin an episode: take all pushes from `rng` from now on, the first one at once."""
        self._rng = rng
        self._push = rng.standard_normal(len(self._push))

    def follow(self, observation: Observation) -> None:
        """See what the expert is to be asked of: it may look at more than a policy is shown."""
        self._present = observation

    def propose(self, observations: Observations) -> Proposal:
        """Propose the expert's action and the present push, within the bounds."""
        del observations
        half_range = (self.action.maximum - self.action.minimum) / 2
        disturbed = self.expert.act(self._present) + self.noise * half_range * self._push
        kept = np.exp(-1 / CORRELATION_STEPS)
        fresh = self._rng.standard_normal(len(self._push))
        self._push = kept * self._push + np.sqrt(1 - kept**2) * fresh
        clipped = np.clip(disturbed, self.action.minimum, self.action.maximum)
        return Proposal(clipped.astype(np.float32)[None])
