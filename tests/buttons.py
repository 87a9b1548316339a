"""A toy task of buttons and binary features, without a camera: the corridor on a keyboard."""

from functools import cache, partial

import numpy as np

from sheath_manip.experiments.study import Study
from sheath_manip.learning.config import LearningPlan
from sheath_manip.task import Task
from sheath_manip.types import Action, ActionSpec, Observation, TaskSpec, Transition
from sheath_manip.types.samples import Samples
from tests.toy import CHOICES as SIDESTEPS
from tests.toy import Corridor, MiddleKeeper

# Neither, left, right; both is no choice.
CHOICES = np.array([[0, 0], [1, 0], [0, 1]], np.float32)
ACTION = ActionSpec(("left_pressed", "right_pressed"), CHOICES[0], np.ones(2, np.float32), CHOICES)
MARKS = np.linspace(-1, 1, 41)
SPEC = TaskSpec(
    name="buttons",
    control_rate_hz=50.0,
    action=ACTION,
    cameras={},
    feature_names=tuple(f"beyond_{mark:.2f}_m" for mark in MARKS),
    max_steps=25,
    metric="progress",
)


class ButtonCorridor(Corridor):
    """The features say beyond which marks one is; `drift_m` is the gust that never ceases."""

    def __init__(self, steps: int = 12, drift_m: float = 0.0) -> None:
        super().__init__(steps)
        self.spec = SPEC
        self.drift_m = drift_m

    def step(self, action: Action) -> Transition:
        pressed = int((action == CHOICES).all(axis=1).argmax())
        return super().step(SIDESTEPS[[1, 0, 2][pressed]] + np.float32(self.drift_m))

    def _observation(self) -> Observation:
        return Observation({}, (self.side_m > MARKS).astype(np.float32), self.done / 50.0)


class ButtonKeeper(MiddleKeeper):
    """The keeper of the middle, on buttons."""

    def act(self, observation: Observation) -> Action:
        sidestep = super().act(observation)
        return CHOICES[[1, 0, 2][int((sidestep == SIDESTEPS).argmax())]]


def make_stage(run_seed: int) -> ButtonCorridor:
    return ButtonCorridor(drift_m=0.05 * (run_seed % 3 - 1))


PLAN = LearningPlan().changed(
    policy={"name": "linear-svm"},
    gate={
        "signal": "support",
        "embedding": "features",
        "support": {"bandwidth_factor": 0.05, "bandwidth_unit": "dimensions"},
        "threshold": {"false_alarm_rate": 0.2, "expert_budget": 0.25},
    },
    comparison={
        "seeds": (0,),
        "final_variant": "stage",
        "evaluation_episodes": 1,
        "final_episodes": 1,
    },
    schedule={
        "variant": "stage",
        "demonstrations": 2,
        "calibration": 3,
        "false_alarm_episodes": 1,
        "rounds": 2,
        "episodes": 2,
    },
)
BUTTONS = Task(
    name="buttons",
    summary="keep to the middle of a windy corridor, by two buttons",
    variants={"default": ButtonCorridor, "final": partial(ButtonCorridor, steps=24)},
    run_variants={"stage": make_stage},
    expert=ButtonKeeper,
)
STUDY = Study(BUTTONS, plans={"full": PLAN, "quick": PLAN})


def button_samples(count: int, seed: int, choices: tuple[int, ...] = (0, 1, 2)) -> Samples:
    """Places of the corridor and what the expert presses there; 50 states an episode."""
    rng = np.random.default_rng(seed)
    # Right of the middle the left button, and the other way round; not within 5 cm of a change.
    low, high = np.array([-0.1, 0.2, -0.9]), np.array([0.1, 0.9, -0.2])
    chosen = rng.choice(choices, count)
    side_m = rng.uniform(low[chosen], high[chosen])
    features = (side_m[:, None] > MARKS).astype(np.float32)
    return Samples({}, features, CHOICES[chosen], np.arange(count) // 50)


@cache
def training() -> Samples:
    return button_samples(300, seed=0)


@cache
def held_out() -> Samples:
    return button_samples(200, seed=1)
