"""A random network that is never trained: the yardstick that trained ones imitate."""

from typing import Self

import numpy as np
from numpy.typing import NDArray

from sheath_manip.protocols import Arrays

HIDDEN = 128


class RandomNetwork:
    """Two layers with ReLU between and no biases: its output grows in proportion to its input."""

    def __init__(self, first: NDArray, second: NDArray) -> None:
        """Take the (d, hidden) and the (hidden, o) matrix."""
        self.first = np.asarray(first, np.float32)
        self.second = np.asarray(second, np.float32)

    @classmethod
    def drawn(cls, inputs: int, outputs: int, rng: np.random.Generator) -> Self:
        """Draw a network of that many inputs and outputs.

        Where the inputs have a mean square of 1, so have the outputs.
        """
        # The factor keeps a mean square of 1 through the ReLU (He et al. 2015).
        first = rng.normal(size=(inputs, HIDDEN)) * np.sqrt(2 / inputs)
        return cls(first, rng.normal(size=(HIDDEN, outputs)) / np.sqrt(HIDDEN))

    def __call__(self, inputs: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return (n, o) outputs for (n, d) inputs."""
        return np.maximum(inputs @ self.first, 0) @ self.second

    def arrays(self) -> Arrays:
        """The two matrices."""
        return {"first": self.first, "second": self.second}

    @classmethod
    def of(cls, arrays: Arrays) -> Self:
        """Make a network from `arrays()`."""
        return cls(arrays["first"], arrays["second"])
