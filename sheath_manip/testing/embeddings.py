"""What every embedding must do."""

from collections.abc import Callable

import numpy as np

from sheath_manip.policies.looking import look, look_to_fit
from sheath_manip.protocols import Embedding, PredictingPolicy
from sheath_manip.testing.sentences import wants, wants_arrays, wants_close, wants_equal
from sheath_manip.types.samples import Samples


def check_embedding(
    make: Callable[[], Embedding], policy: PredictingPolicy, samples: Samples
) -> None:
    """Check an embedding of a fitted `policy` on `samples`, that the policy was fitted to.

    `make` is called without arguments, as the members of EMBEDDINGS are.
    """

    def vectors_of(embedding: Embedding, some: Samples) -> np.ndarray:
        return embedding.transform(look(policy, some, embedding.attach(policy)))

    embedding = make()
    wants(isinstance(embedding.uses_displaced, bool), "uses_displaced must be a bool")
    readers = embedding.attach(policy)
    wants(embedding.attach(policy) == readers, "attached again it must read the same")
    wants(len(set(readers)) == len(readers), "no two of its readers may read the same")
    seen = look_to_fit(policy, samples, embedding)
    wants(embedding.fit(seen) is embedding, "fit must return the embedding itself")
    vectors = vectors_of(embedding, samples)
    wants(
        vectors.ndim == 2 and len(vectors) == len(samples) and vectors.dtype == np.float32,
        f"transform gave {vectors.dtype} of shape {vectors.shape}; wanted float32 (n, d)",
    )
    wants(bool(np.isfinite(vectors).all()), "vectors of training states must be finite")
    wants_close(
        vectors_of(embedding, samples.take(np.arange(1))),
        vectors[:1],
        "a state alone must be embedded as among others",
        2e-3,
    )
    loaded = make().load(wants_arrays(embedding))
    wants_equal(
        vectors_of(loaded, samples),
        vectors,
        "an embedding that took over learned arrays must give the same vectors",
    )
