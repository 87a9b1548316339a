"""What every policy must do."""

from collections.abc import Callable

import numpy as np

from sheath_manip.protocols import Policy, TrainablePolicy
from sheath_manip.testing.sentences import (
    wants,
    wants_a,
    wants_arrays,
    wants_close,
    wants_equal,
    wants_stored_hyperparameters,
)
from sheath_manip.testing.states import drawn_states
from sheath_manip.types import Proposal, TaskSpec
from sheath_manip.types.samples import Samples

MakePolicy = Callable[..., Policy]
"""called with the task's spec and `seed`"""
TRAINABLE = ("fit", "predict", "surrogate_losses", "arrays", "load")
BECAUSE_OF_FIT = "it has a method `fit`, so it is held to TrainablePolicy"


def check_policy(make: MakePolicy, spec: TaskSpec, samples: Samples | None = None) -> None:
    """Check a policy on a task's `spec`; what has `fit` is held to TrainablePolicy.

    Args:
        make: called with `spec` and `seed`, as the members of POLICIES are.
        spec: of a task that the policy is for.
        samples: states with labels; drawn at random from the spec where there are none.
    """
    samples = drawn_states(spec) if samples is None else samples
    policy = make(spec, seed=0)
    if hasattr(policy, "fit"):
        try:
            _check_trainable(make, spec, samples)
        except AssertionError as error:
            raise AssertionError(f"{BECAUSE_OF_FIT}: {error}") from error
        policy = policy.fit(samples)  # pyright: ignore[reportAttributeAccessIssue]
    _check_driving(policy, spec, samples)


def _check_driving(policy: Policy, spec: TaskSpec, samples: Samples) -> None:
    def driven(seed: int) -> list[np.ndarray]:
        policy.reset(np.random.default_rng(seed))
        alone = [samples.observations.rows(slice(i, i + 1)) for i in range(5)]
        return [wants_a(Proposal, policy.propose(each), "propose").now for each in alone]

    first = driven(0)
    for action in first:
        wants(
            action.shape == (1, len(spec.action.names)),
            f"propose gave actions of shape {action.shape} for one state; wanted "
            f"(1, {len(spec.action.names)}), or chunks of such",
        )
        spec.action.validated(action[0])
    for one, again in zip(first, driven(0), strict=True):
        wants_equal(again, one, "after reset with the same rng a policy must propose the same")


def _check_trainable(make: MakePolicy, spec: TaskSpec, samples: Samples) -> None:
    def fitted() -> TrainablePolicy:
        return make(spec, seed=0).fit(samples)  # pyright: ignore[reportAttributeAccessIssue]

    fresh = make(spec, seed=0)
    lacking = [name for name in TRAINABLE if not hasattr(fresh, name)]
    wants(not lacking, f"{type(fresh).__name__} lacks {', '.join(lacking)}")
    wants_stored_hyperparameters(fresh)
    policy = fitted()
    wants(
        fresh.fit(samples) is fresh,  # pyright: ignore[reportAttributeAccessIssue]
        "fit must return the policy itself",
    )
    proposal = wants_a(Proposal, policy.predict(samples.observations), "predict")
    predicted = proposal.now
    wants(
        predicted.shape == samples.labels.shape,
        f"predict gave actions of shape {predicted.shape}; wanted {samples.labels.shape}",
    )
    wants(bool(np.isfinite(predicted).all()), "predicted actions must be finite")
    wants_equal(
        fitted().predict(samples.observations).now,
        predicted,
        "the same seed and samples must give the same policy",
    )
    wants_close(
        policy.predict(samples.observations.rows(slice(0, 1))).now,
        predicted[:1],
        "a state alone must be predicted as among others",
        1e-3,
    )
    losses = policy.surrogate_losses(proposal, samples.labels)
    wants(
        losses.shape == (len(samples),) and bool(((losses >= 0) & (losses <= 1)).all()),
        "surrogate losses must be one a state, in 0..1",
    )
    agreeing = policy.surrogate_losses(proposal, predicted)
    wants(
        float(agreeing.mean()) <= float(losses.mean()) + 1e-6,
        "a policy's loss against its own actions must be no larger than against others",
    )
    loaded = make(spec, seed=1).load(wants_arrays(policy))  # pyright: ignore
    wants_equal(
        loaded.predict(samples.observations).now,
        predicted,
        "a policy that took over learned arrays must predict the same",
    )
