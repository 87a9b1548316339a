"""Distances that count what displacement shows and traffic does not."""

from typing import ClassVar, Self

import numpy as np
from numpy.typing import NDArray
from sklearn.covariance import ledoit_wolf

from sheath_manip.exceptions import ParameterError
from sheath_manip.policies.scaling import Whitening


class ContrastWhitening(Whitening):
    """Whitened, then cut to the directions in which displaced states are wider than training ones.

    Whitening counts every direction alike, so that a scene that is merely new drowns a robot that
    stands askew. With z whitened and S the second moment of the z of displaced states, |z|² in the
    metric I - S⁻¹ is, but for a constant, twice the Gaussian log-likelihood ratio of displaced to
    natural states: cf. Ren et al. 2019, 'Likelihood ratios for out-of-distribution detection'. In
    S's eigenbasis each direction is scaled by √(1 - 1/λ); those with λ <= 1, in which displacement
    shows no more than training does, are dropped.
    """

    uses_displaced: ClassVar[bool] = True

    def __init__(self, most: int | None = None) -> None:
        """Store the hyperparameter; ParameterError where it leaves nothing.

        Args:
            most: directions that are kept, of those left the ones with the largest λ; all where
                None. Each step of a robot pays for every one of them.
        """
        super().__init__(most)

    def fit(self, X: NDArray, displaced: NDArray | None = None) -> Self:
        """Fit to (n, d) vectors and (m, d) of displaced states; ParameterError for any other."""
        directions, roots = self._directions(X)
        self._take((directions / roots) @ directions.T)
        wanted = f"(m > 0, {len(self.matrix_)})"
        if displaced is None:
            raise ParameterError(
                f"ContrastWhitening needs vectors of displaced states, {wanted}; pass `displaced`"
            )
        if displaced.shape != (len(displaced) or 1, len(self.matrix_)) or not (
            np.isfinite(displaced).all()
        ):
            raise ParameterError(
                f"cannot contrast with displaced vectors of shape {displaced.shape}; "
                f"wanted finite {wanted}"
            )
        Z = self.transform(displaced).astype(np.float64)
        covariance, _ = ledoit_wolf(Z, assume_centered=True)
        values, vectors = np.linalg.eigh(covariance)
        wider = values > 1
        # They come in rising order.
        if self.most is not None:
            wider[: -self.most] = False
        # Where nothing is wider there is no contrast to judge by, and whitening has to do.
        if wider.any():
            basis = vectors[:, wider] * np.sqrt(1 - 1 / values[wider])
            self._take(self.matrix_ @ basis)
        return self
