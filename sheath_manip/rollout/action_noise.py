"""Demonstrations by an expert whose hand is pushed about, and who always says what is right.

Laskey et al. 2017, 'DART: Noise injection for robust imitation learning' (CoRL): the expert's
action is executed with noise and labelled without, so that the demonstrations show the way back
from where a policy's own errors will lead. In the one loop this is a policy, under a gate that asks
for a label at every step.
"""

import numpy as np

from sheath_manip.exceptions import ParameterError
from sheath_manip.protocols import Expert
from sheath_manip.types import Action, ActionSpec, Observation

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

    def draw_from(self, rng: np.random.Generator) -> None:
        """Take all pushes from `rng` from now on, and begin with a fresh one."""
        self._rng = rng
        self._push = rng.standard_normal(len(self._push))

    def act(self, observation: Observation) -> Action:
        """(a,) the expert's action and the present push, within the bounds."""
        half_range = (self.action.maximum - self.action.minimum) / 2
        disturbed = self.expert.act(observation) + self.noise * half_range * self._push
        kept = np.exp(-1 / CORRELATION_STEPS)
        fresh = self._rng.standard_normal(len(self._push))
        self._push = kept * self._push + np.sqrt(1 - kept**2) * fresh
        return np.clip(disturbed, self.action.minimum, self.action.maximum).astype(np.float32)
