"""A task without a simulator: bring a slider to the mark, past gusts."""

import numpy as np

from sheath_manip.task import Task
from sheath_manip.types import ActionSpec, Observation, Outcome, TaskSpec, Transition

SPEC = TaskSpec(
    name="slide",
    control_rate_hz=10.0,
    action=ActionSpec(("speed",), np.array([-1], np.float32), np.array([1], np.float32)),
    cameras={},
    feature_names=("offset_m",),
    max_steps=30,
    metric="offset_m",
)


class Slide:
    """The slider starts up to 2 m off; within 5 cm of the mark it is done."""

    spec = SPEC

    def reset(self, seed: int) -> Observation:
        """Draw the start and the gusts."""
        rng = np.random.default_rng(seed)
        self._gusts_m = rng.normal(0, 0.03, SPEC.max_steps)
        self._offset_m, self._steps = float(rng.uniform(-2, 2)), 0
        return self._seen()

    def step(self, action: np.ndarray) -> Transition:
        """Move by a fifth of the speed, and by the gust."""
        speed = float(SPEC.action.validated(action)[0])
        self._offset_m += 0.2 * speed + float(self._gusts_m[self._steps])
        self._steps += 1
        done = self.outcome() is Outcome.SUCCESS
        return Transition(self._seen(), 0.0, done, not done and self._steps >= SPEC.max_steps)

    def outcome(self) -> Outcome:
        """SUCCESS at the mark."""
        return Outcome.SUCCESS if abs(self._offset_m) < 0.05 else Outcome.TIME_LIMIT

    def metrics(self) -> dict[str, float]:
        """How far off it is."""
        return {"offset_m": abs(self._offset_m)}

    def state(self) -> np.ndarray:
        """(2,) offset and step."""
        return np.array([self._offset_m, self._steps])

    def restore(self, state: np.ndarray) -> Observation:
        """Continue from there."""
        self._offset_m, self._steps = float(state[0]), int(state[1])
        return self._seen()

    def close(self) -> None:
        """Nothing to free."""

    def _seen(self) -> Observation:
        return Observation({}, np.array([self._offset_m], np.float32), self._steps / 10)


class Pusher:
    """The expert: towards the mark, as fast as it is far."""

    def __init__(self, environment: Slide) -> None:
        del environment

    def reset(self) -> None:
        """Nothing to forget."""

    def act(self, observation: Observation) -> np.ndarray:
        """(1,) the speed."""
        return np.clip(-5 * observation.features, -1, 1).astype(np.float32)


SLIDE = Task(
    name="slide",
    summary="bring a slider to the mark",
    variants={"default": Slide, "final": Slide},
    expert=Pusher,
)
