"""What a layer of anybody's policy shows, as the vector on which the support is estimated."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, final

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError
from sheath_manip.policies.embeddings import ScaledEmbedding
from sheath_manip.policies.readings import INSTEAD
from sheath_manip.protocols import PredictingPolicy, Reader
from sheath_manip.types import Observations, Proposal

LATENT = "latent"
"""the name of the latent that is read where a policy gives several"""
SCORES = "choice scores"
"""the name of what a policy makes of each choice, which is no layer inside"""


@dataclass(frozen=True)
class FlatLatent:
    """The latent `latent`, or the only one that there is, each state's numbers in one row."""

    def __call__(self, observations: Observations, proposal: Proposal) -> NDArray[np.float32]:
        """(n, d); ParameterError where the policy gives none, or several of other names."""
        latents = proposal.latents
        name = latent_of(latents)
        if name is None:
            given = ", ".join(sorted(map(str, latents)))
            told = f"gives several ({given}), none called {LATENT!r}" if given else "gives none"
            raise ParameterError(
                f"the embedding reads a latent of the policy, which {told}; wanted one, as "
                f"`from_torch(module, embed=LAYER)` gives it, or {INSTEAD}"
            )
        latent = np.asarray(latents[name], np.float32)
        return latent.reshape(len(observations), math.prod(latent.shape[1:]))


def latent_of(latents: Mapping[str, Any]) -> str | None:
    """Return the name of the latent that `FlatLatent` reads; None where it reads none."""
    inside = [name for name in latents if name != SCORES]
    if LATENT in inside:
        return LATENT
    return inside[0] if len(inside) == 1 else None


@final
class LatentEmbedding(ScaledEmbedding):
    """What a layer of the policy shows, whatever its shape; standardised by default.

    A layer of up to some thousand numbers a state is best: all of them are kept.
    """

    def readers(self, policy: PredictingPolicy) -> tuple[Reader, ...]:
        """(n, d)."""
        del policy
        return (FlatLatent(),)
