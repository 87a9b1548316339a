"""Embeddings and signals on samples: attached, looked for, fitted or asked."""

import numpy as np
from numpy.typing import NDArray

from sheath_manip.policies.looking import look, look_to_fit
from sheath_manip.protocols import Agreement, Embedding, PredictingPolicy, Signal
from sheath_manip.types.samples import Samples
from sheath_manip.types.seen import Seen


def seen_by(seeing: Signal | Embedding, policy: PredictingPolicy, samples: Samples) -> Seen:
    return look(policy, samples, seeing.attach(policy))


def fitted_embedding(embedding: Embedding, policy: PredictingPolicy, samples: Samples) -> Embedding:
    return embedding.fit(look_to_fit(policy, samples, embedding))


def vectors_of(
    embedding: Embedding, policy: PredictingPolicy, samples: Samples
) -> NDArray[np.float32]:
    return embedding.transform(seen_by(embedding, policy, samples))


def fitted_signal(
    signal: Signal,
    policy: PredictingPolicy,
    samples: Samples,
    agreement: Agreement | None = None,
) -> Signal:
    return signal.fit(samples.labels, look_to_fit(policy, samples, signal), agreement)


def measures_of(signal: Signal, policy: PredictingPolicy, samples: Samples) -> NDArray[np.float64]:
    return signal.measure(seen_by(signal, policy, samples))


def scores_of(signal: Signal, policy: PredictingPolicy, samples: Samples) -> NDArray[np.float64]:
    return signal.scores(measures_of(signal, policy, samples))
