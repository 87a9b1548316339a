"""What is the same for all policies that act on the present observation alone."""

from abc import ABC, abstractmethod

import numpy as np

from sheath_manip.types import Observations, Proposal


class Memoryless(ABC):
    """A policy that keeps nothing from step to step and draws nothing."""

    @abstractmethod
    def predict(self, observations: Observations) -> Proposal:
        """Look at n states that have nothing to do with each other."""

    def reset(self, rng: np.random.Generator) -> None:
        """Begin an episode: there is nothing to forget."""
        del rng

    def propose(self, observations: Observations) -> Proposal:
        """Propose for the present observation what is predicted for it."""
        return self.predict(observations)
