"""Every policy of the table with a toy task of what it looks at, fitted once for all tests."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from sheath_manip.policies import POLICIES, make_policy
from sheath_manip.protocols import TrainablePolicy
from sheath_manip.types import ActionSpec, TaskSpec
from sheath_manip.types.samples import Samples
from tests import blobs, buttons, line, reach, servo

# Others are fitted in one stroke.
EPOCHS = {"epochs": 2}
STEPS = {"steps": 4, "warm_steps": 2}
QUICK = {
    "cnn": EPOCHS,
    "plain-cnn": EPOCHS,
    "paper-cnn": EPOCHS,
    "spatial-cnn": reach.SETTINGS | STEPS,
    "mlp": servo.SETTINGS | STEPS,
    "act": reach.ACT_SETTINGS | STEPS,
    "egocentric-cnn": {"spatial_settings": line.SETTINGS["spatial_settings"] | STEPS},
}
OF_FEATURES = ("linear-svm", "linear-svm-paper", "smile")
CONTINUOUS = ("spatial-cnn", "act", "egocentric-cnn", "mlp")
every_policy = pytest.mark.parametrize("name", sorted(POLICIES))
every_classifier = pytest.mark.parametrize("name", sorted(set(POLICIES) - set(CONTINUOUS)))
every_regressor = pytest.mark.parametrize("name", CONTINUOUS)


@dataclass(frozen=True)
class Toy:
    """A task and states of it."""

    spec: TaskSpec
    samples: Callable[..., Samples]
    """(count, seed), and for tasks of choices those that there are"""
    nudge: np.ndarray
    """(a,) what an action may be off by and still count as the same"""
    missing: dict[str, Any]
    """a spec without what the policy looks at"""
    complaint: str
    """what is then said"""
    another: dict[str, Any]
    """a spec for which what was learned is of no use"""
    refusal: str
    """what is then said"""


def _of_two_choices(spec: TaskSpec) -> ActionSpec:
    assert spec.action.choices is not None
    return replace(spec.action, choices=spec.action.choices[:2])


SEEN = Toy(
    blobs.SPEC,
    blobs.blob_samples,
    np.array([0.02]),
    {"cameras": {}},
    "no camera",
    {"action": _of_two_choices(blobs.SPEC)},
    r"2 choices|shape \(2, ",
)
PRESSED = Toy(
    buttons.SPEC,
    buttons.button_samples,
    np.full(2, 0.2),
    {"feature_names": ()},
    "no features",
    {"feature_names": buttons.SPEC.feature_names[:3]},
    r"wanted numbers of shape \(2, 4\)",
)
REACHED = Toy(
    reach.SPEC,
    reach.reach_samples,
    np.zeros(2),
    {"cameras": {}},
    "no camera",
    {"feature_names": reach.SPEC.feature_names[:1]},
    "1 features",
)
FOLLOWED = Toy(
    line.SPEC,
    line.line_samples,
    np.zeros(2),
    {"tool_frame": None},
    "no tool frame",
    {"feature_names": (*line.SPEC.feature_names, "force_n")},
    "2 features",
)

SERVOED = Toy(
    servo.SPEC,
    servo.servo_samples,
    np.zeros(2),
    {"feature_names": ()},
    "no features",
    {"feature_names": servo.SPEC.feature_names[:1]},
    "1 features",
)
REGRESSED = {"spatial-cnn": REACHED, "act": REACHED, "egocentric-cnn": FOLLOWED, "mlp": SERVOED}


def toy(name: str) -> Toy:
    if name in CONTINUOUS:
        return REGRESSED[name]
    return PRESSED if name in OF_FEATURES else SEEN


@cache
def held_out(name: str) -> Samples:
    return toy(name).samples(200, seed=1)


@cache
def fitted_policy(name: str) -> TrainablePolicy:
    """Fitted once for all tests, which must not fit it again."""
    if name == "mlp":
        return servo.fitted_policy()
    if name in CONTINUOUS:
        return (line if name == "egocentric-cnn" else reach).fitted_policy(name)
    if name not in OF_FEATURES:
        return blobs.fitted_policy(name)
    return make_policy(name, buttons.SPEC).fit(buttons.training())


def quick(name: str) -> dict[str, Any]:
    return QUICK.get(name, {})


def shape(name: str) -> dict[str, Any]:
    """What a policy must be given to take over what `fitted_policy` learned."""
    return {
        "spatial-cnn": reach.SETTINGS,
        "egocentric-cnn": line.SETTINGS,
        "mlp": servo.SETTINGS,
        "act": reach.ACT_SETTINGS,
    }.get(name, {})


def predicted_by(policy: TrainablePolicy, samples: Samples) -> np.ndarray:
    return policy.predict(samples.observations).now


def losses_of(policy: TrainablePolicy, samples: Samples) -> np.ndarray:
    return policy.surrogate_losses(policy.predict(samples.observations), samples.labels)
