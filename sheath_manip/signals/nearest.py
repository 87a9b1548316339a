"""The training states that are nearest to one state: what a person is shown of a precedent."""

import numpy as np
from numpy.typing import NDArray

from sheath_manip.types.seen import Precedents


def nearest(
    vector: NDArray, vectors: NDArray, labels: NDArray, proposed: NDArray, count: int
) -> Precedents | None:
    """Return the `count` of (m, d) `vectors` that are nearest to (d,) `vector`.

    Distances are in units of the root of the vectors' total variance, so that 1 is as far as a
    training state lies from their middle. The answer is None where `vector` is not finite.

    Args:
        vector: of the state.
        vectors: of the training states.
        labels: (m, a) what the expert did there.
        proposed: (a,) what the policy proposes, in the frame of the labels.
        count: at most m are returned.
    """
    apart = np.sqrt(((vectors - vector) ** 2).sum(axis=1, dtype=np.float64))
    if not np.isfinite(apart).all():
        return None
    # Only as many as are wanted are sorted; of equally near ones the first comes first.
    few = np.argsort(apart, kind="stable")[:count]
    spread = float(np.sqrt(vectors.var(axis=0, dtype=np.float64).sum()))
    return Precedents(
        few, apart[few] / (spread or 1.0), labels[few], np.asarray(proposed), len(vectors)
    )
