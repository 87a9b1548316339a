"""What every support estimator must do."""

from collections.abc import Callable

import numpy as np

from sheath_manip.protocols import SupportEstimator
from sheath_manip.testing.sentences import (
    wants,
    wants_arrays,
    wants_close,
    wants_equal,
    wants_refusal,
    wants_stored_hyperparameters,
)


def check_support(make: Callable[[], SupportEstimator]) -> None:
    """Check a support estimator on clouds of points; `make` gives a fresh one."""
    rng = np.random.default_rng(0)
    points = rng.normal(size=(200, 6))
    support = make()
    wants_stored_hyperparameters(support)
    wants(isinstance(support.uses_agreement, bool), "uses_agreement must be a bool of the class")
    wants(support.fit(points) is support, "fit must return the estimator itself")
    scores = support.decision_function(points)
    wants(
        scores.shape == (200,) and scores.dtype == np.float64,
        f"decision_function gave {scores.dtype} of shape {scores.shape}; wanted float64 (n,)",
    )
    wants(float((scores >= 0).mean()) >= 0.5, "most training points must lie inside, at 0 or above")
    far = support.decision_function(np.stack([np.full(6, 50.0), np.full(6, 1e12)]))
    wants(bool((far < 0).all()), f"points far away must score below 0, but score {far}")
    bad = np.zeros((2, 6))
    bad[:, 0] = np.nan, np.inf
    wants(
        bool(np.isnan(support.decision_function(bad)).all()),
        "a row that is not finite must score NaN",
    )
    wants_close(
        support.decision_function(points[:1]), scores[:1], "a row alone must score as among others"
    )
    wants(support.decision_function(points[:0]).shape == (0,), "no rows must give no scores")
    wants_equal(
        make().fit(points).decision_function(points), scores, "the same points must fit the same"
    )
    loaded = make().load(wants_arrays(support))
    wants_equal(
        loaded.decision_function(points),
        scores,
        "an estimator that took over learned arrays must score the same",
    )
    agrees = points[:, 0] < 0.5
    told = make().fit(points, agrees).decision_function(points)
    wants(
        support.uses_agreement or np.array_equal(told, scores),
        "an estimator that does not use agreement must fit the same with it",
    )
    for wrong, what in ((np.zeros(5), "one axis"), (np.full((4, 3), np.nan), "not finite")):
        wants_refusal(lambda wrong=wrong: make().fit(wrong), f"data of {what} must be refused")
    wants_refusal(
        lambda: support.decision_function(points[:, :3]), "rows of another width must be refused"
    )
