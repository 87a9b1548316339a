"""What every signal must do."""

from collections.abc import Callable

import numpy as np

from sheath_manip.policies.looking import look, look_to_fit
from sheath_manip.protocols import HasParts, HasPrecedents, PredictingPolicy, Signal
from sheath_manip.testing.sentences import wants, wants_arrays, wants_close, wants_equal
from sheath_manip.types import Reason
from sheath_manip.types.samples import Samples


def check_signal(make: Callable[[], Signal], policy: PredictingPolicy, samples: Samples) -> None:
    """Check a signal of a fitted `policy`; `samples`, that it was fitted to, want 2 episodes.

    `make` gives a fresh signal, such as `lambda: make_signal(choice)`.
    """
    signal = make()
    readers = signal.attach(policy)
    wants(signal.attach(policy) == readers, "attached again it must read the same")
    seen = look_to_fit(policy, samples, signal)
    agrees = np.ones(len(samples), bool)
    wants(
        signal.fit(samples.labels, seen, lambda: agrees) is signal,
        "fit must return the signal itself",
    )
    measures = signal.measure(look(policy, samples, readers))
    wants(
        measures.ndim == 2 and len(measures) == len(samples) and measures.dtype == np.float64,
        f"measure gave {measures.dtype} of shape {measures.shape}; wanted float64 (n, p)",
    )
    episodes = [measures[samples.episodes == one] for one in np.unique(samples.episodes)]
    wants(signal.calibrate(episodes) is signal, "calibrate must return the signal itself")
    scores = signal.scores(measures)
    wants(scores.shape == (len(samples),), "scores must be one a state")
    wants(not np.isnan(scores).all(), "some training state must have a score")
    wants_close(signal.scores(measures[:1]), scores[:1], "a state alone must score as among others")
    wants(
        isinstance(signal.blames(measures[0]), Reason),
        "blames must give a Reason for one state's measures",
    )
    if isinstance(signal, HasParts):
        parts = signal.signal_scores(measures[0])
        named = [each.signal for each in parts]
        wants(named == sorted(set(named)), "signal_scores must be sorted by name, each once")
        wants(
            all(0 <= each.share <= 1 for each in parts),
            "the share of expert steps that score lower must lie in 0..1",
        )
    if isinstance(signal, HasPrecedents):
        found = signal.nearest_states(look(policy, samples.take(np.array([0])), readers), 3)
        if found is not None:
            wants(
                len(found.indices) == min(3, len(samples)) and found.total == len(samples),
                "nearest_states must give as many of the training states as were asked for",
            )
            wants(bool((np.diff(found.distances) >= 0).all()), "the nearest must come first")
            wants(float(found.distances[0]) < 1e-2, "a training state must be nearest to itself")
    loaded = make().load(wants_arrays(signal))
    wants_equal(
        loaded.scores(loaded.measure(look(policy, samples, loaded.attach(policy)))),
        scores,
        "a signal that took over learned arrays must score the same",
    )
