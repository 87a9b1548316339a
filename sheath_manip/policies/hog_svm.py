"""A linear support vector machine on histograms of oriented gradients.

Dalal & Triggs 2005, 'Histograms of oriented gradients for human detection'. The problem is convex:
each fit starts anew and ends at the same machine.
"""

from collections.abc import Mapping
from typing import Self

import cv2
import numpy as np
from numpy.typing import NDArray
from skimage.feature import hog
from sklearn.svm import LinearSVC

from sheath_manip.exceptions import ParameterError
from sheath_manip.policies.choices import (
    choices_of,
    likeliest,
    nearest_choices,
    zero_one_losses,
)
from sheath_manip.policies.learned_arrays import numbers
from sheath_manip.policies.memoryless import Memoryless
from sheath_manip.policies.requirements import require_camera
from sheath_manip.protocols import Arrays
from sheath_manip.types import Observations, Proposal, TaskSpec
from sheath_manip.types.samples import Samples

CELLS_PER_BLOCK = 2
ORIENTATIONS = 9
MOST_SIDE_PX = 1024
"""of the image: no memory is taken for more, whatever a checkpoint says"""


class HogSvm(Memoryless):
    """A linear classifier over `spec.action.choices` on the first camera's oriented gradients."""

    def __init__(
        self,
        spec: TaskSpec,
        side: int = 72,
        cell: int = 12,
        penalty: float = 0.1,
        seed: int = 0,
    ) -> None:
        """Store the hyperparameters.

        Args:
            spec: of the task; its first camera is the one looked at.
            side: pixels of the square grey image that the gradients are taken of.
            cell: pixels of a histogram's cell. 72 and 12 give 900 numbers in under a millisecond,
                the usual 8-pixel cells 1764 in 1.4.
            penalty: C of the support vector machine.
            seed: unused, since nothing is drawn; policies are all made alike.
        """
        self.spec = spec
        self.side = side
        self.cell = cell
        self.penalty = penalty
        self.seed = seed
        self.choices = choices_of(spec)
        require_camera(spec)
        if not 1 <= cell <= side // CELLS_PER_BLOCK or side > MOST_SIDE_PX:
            raise ParameterError(
                f"side is {side} px and cell {cell} px; wanted at least two cells, and at most "
                f"{MOST_SIDE_PX} px"
            )
        self.camera = next(iter(spec.cameras))

    def fit(self, samples: Samples) -> Self:
        """Fit to (n, a) labels, each taken as its nearest choice; ParameterError for none."""
        if len(samples) == 0:
            raise ParameterError("no samples to fit to; wanted at least one labelled state")
        gradients = self.gradients(samples.images)
        classes = nearest_choices(self.choices, samples.labels)
        seen = np.unique(classes)
        # A choice that no label asks for is never predicted.
        self.weights_ = np.zeros((len(self.choices), gradients.shape[1]), dtype=np.float32)
        self.biases_ = np.full(len(self.choices), -np.inf, dtype=np.float32)
        if len(seen) == 1:
            self.biases_[seen] = 0
            return self
        # The primal solver draws nothing and converges; sklearn's stubs know only "auto".
        machine = LinearSVC(C=self.penalty, dual=False)  # pyright: ignore[reportArgumentType]
        machine.fit(gradients, classes)
        # Two classes share one hyperplane: each gets its own side of it.
        signs = np.array([[-1], [1]]) if len(seen) == 2 else np.ones((len(seen), 1))
        self.weights_[seen] = signs * machine.coef_
        self.biases_[seen] = (signs * np.reshape(machine.intercept_, (-1, 1)))[:, 0]
        return self

    def predict(self, observations: Observations) -> Proposal:
        """Take the best choices; features go unused.

        Latents: the machines' scores as (n, k) `choice scores`, -inf for a choice that no label
        asked for.
        """
        scores = self.gradients(observations.images) @ self._fitted().T + self.biases_
        return Proposal(likeliest(self.choices, scores), {"choice scores": scores})

    def gradients(self, images: Mapping[str, NDArray[np.uint8]]) -> NDArray[np.float32]:
        """(n, d) histograms of oriented gradients."""
        rows = [self._gradients_of(image) for image in images[self.camera]]
        return np.stack(rows) if rows else np.empty((0, self._width), dtype=np.float32)

    def surrogate_losses(self, proposal: Proposal, labels: NDArray) -> NDArray[np.float32]:
        """(n,) 1 where predicted and labelled controls differ, else 0 (Eq. 8, righted)."""
        return zero_one_losses(self.choices, proposal.now, labels)

    def arrays(self) -> Arrays:
        """Weights (k, d) and biases (k,)."""
        return {"weights": self._fitted(), "biases": self.biases_}

    def load(self, arrays: Arrays) -> Self:
        """Take over `arrays()`; ParameterError for other shapes."""
        self.weights_ = numbers(arrays, "weights", len(self.choices), self._width)
        self.biases_ = numbers(arrays, "biases", len(self.choices))
        return self

    @property
    def _width(self) -> int:
        """d."""
        return ORIENTATIONS * (self.side // self.cell - 1) ** 2 * CELLS_PER_BLOCK**2

    def _gradients_of(self, image: NDArray[np.uint8]) -> NDArray[np.float32]:
        grey = cv2.cvtColor(image, cv2.COLOR_RGB2GRAY)
        small = cv2.resize(grey, (self.side, self.side), interpolation=cv2.INTER_AREA)
        return hog(
            small,
            orientations=ORIENTATIONS,
            pixels_per_cell=(self.cell, self.cell),
            cells_per_block=(CELLS_PER_BLOCK, CELLS_PER_BLOCK),
        ).astype(np.float32)

    def _fitted(self) -> NDArray[np.float32]:
        if not hasattr(self, "weights_"):
            raise ParameterError("the policy is not fitted yet; call fit or load first")
        return self.weights_
