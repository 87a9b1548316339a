"""Looking at states through a policy: each image passes each network once."""

from collections.abc import Hashable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sheath_manip.policies.displacement import displaced
from sheath_manip.protocols import Embedding, PredictingPolicy, Reader, Signal
from sheath_manip.seeding import generator
from sheath_manip.types import Observation, Proposal
from sheath_manip.types.samples import Samples
from sheath_manip.types.seen import Seen

BATCH = 128
"""states looked at together: enough to fill the matrix units, few enough that the first layer's
output stays in cache"""
MOST_DISPLACED = 3000
"""more displaced images tell no more, and cost a second a thousand"""


def look(policy: PredictingPolicy, samples: Samples, readers: Sequence[Reader] = ()) -> Seen:
    """Return `samples` as `policy` sees them, with what `readers` take and the surrogate losses."""
    # Features alone are few numbers, and one product over all of them is quickest.
    together = BATCH if samples.images else max(len(samples), 1)
    parts = [
        _looked(policy, samples, slice(first, first + together), readers)
        for first in range(0, max(len(samples), 1), together)
    ]
    return parts[0] if len(parts) == 1 else end_to_end(parts)


def look_to_fit(policy: PredictingPolicy, samples: Samples, to_fit: Signal | Embedding) -> Seen:
    """Return training states as `policy` sees them, with all that `to_fit` wants to be fitted to.

    `to_fit` is attached to the policy by this.
    """
    return look_with_displaced(policy, samples, to_fit.attach(policy), to_fit.uses_displaced)


def look_with_displaced(
    policy: PredictingPolicy, samples: Samples, readers: Sequence[Reader], displacing: bool
) -> Seen:
    """Return training states as `policy` sees them, with displaced ones if `displacing`."""
    seen = look(policy, samples, readers)
    if not displacing:
        return seen
    count = min(MOST_DISPLACED, 2 * len(samples))
    rows = generator("displaced images"), count
    elsewhere = Samples(
        displaced(samples.images, *rows),
        np.zeros((count, samples.features.shape[1]), np.float32),
        np.full((count, samples.labels.shape[1]), np.nan, np.float32),
        np.zeros(count, np.int64),
    )
    return replace(seen, displaced=look(policy, elsewhere, readers))


def seen_in(observation: Observation, proposal: Proposal, readers: Sequence[Reader]) -> Seen:
    """Return one state as the policy saw it when it made `proposal`: nothing is looked at again."""
    alone = observation.alone
    readings: dict[Hashable, NDArray] = {reader: reader(alone, proposal) for reader in readers}
    return Seen(alone.features, proposal.now, readings)


def _looked(
    policy: PredictingPolicy, samples: Samples, rows: slice, readers: Sequence[Reader]
) -> Seen:
    observations, labels = samples.observations.rows(rows), samples.labels[rows]
    proposal = policy.predict(observations)
    readings: dict[Hashable, NDArray] = {
        reader: reader(observations, proposal) for reader in readers
    }
    losses = policy.surrogate_losses(proposal, labels)
    known = np.where(np.isfinite(labels[:, 0]), losses, np.float32(np.nan))
    return Seen(observations.features, proposal.now, readings, known)


def end_to_end(parts: Sequence[Seen]) -> Seen:
    """Return the states of several looks with the same readers."""

    def joined(arrays: Sequence[NDArray]) -> NDArray:
        return np.concatenate(arrays)

    return Seen(
        joined([part.features for part in parts]),
        joined([part.actions for part in parts]),
        {reader: joined([part.readings[reader] for part in parts]) for reader in parts[0].readings},
        joined([part.losses for part in parts if part.losses is not None]),
    )
