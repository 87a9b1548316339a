"""Parts of a run that can be made faulty, and an environment that knows what really happened."""

from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any

import numpy as np

from sheath_manip.rollout import audience, telling
from sheath_manip.types import (
    Action,
    Observation,
    Observations,
    Outcome,
    Proposal,
    Transition,
)
from tests.faults.ways import Way
from tests.toy import CHOICES, Corridor


class Faulty:
    """Another part, of which one method goes wrong at some of its calls."""

    def __init__(self, part: Any, method: str, way: Way, first: int = 0, times: int = 1) -> None:
        """The calls `first` .. `first + times - 1` of `method` go the `way`."""
        self.part = part
        self.method = method
        self.way = way
        self.calls = range(first, first + times)
        self.called = 0

    @property
    def met(self) -> bool:
        """Whether anything went wrong so far."""
        return self.called > self.calls.start

    def __getattr__(self, name: str) -> Any:
        value = getattr(self.part, name)
        return partial(self._call, value) if name == self.method else value

    def _call(self, call: Any, *arguments: Any) -> Any:
        place, self.called = self.called, self.called + 1
        return self.way(call, *arguments) if place in self.calls else call(*arguments)


class Witness(Corridor):
    """A corridor without walls that writes down what is done in it, and what it showed then."""

    def __init__(self, steps: int = 12) -> None:
        super().__init__(steps)
        self.done_actions: list[Action] = []
        self.shown: list[Observation] = []

    def reset(self, seed: int) -> Observation:
        return self._shown(super().reset(seed))

    def step(self, action: Action) -> Transition:
        self.done_actions.append(action.copy())
        made = super().step(action)
        self._shown(made.observation)
        # A robot's driver may scale in place what it is given.
        action *= 0
        return made

    def outcome(self) -> Outcome:
        return Outcome.SUCCESS if self.done >= self.steps else Outcome.TIME_LIMIT

    def _shown(self, seen: Observation) -> Observation:
        images = {camera: image.copy() for camera, image in seen.images.items()}
        self.shown.append(Observation(images, seen.features.copy(), seen.time_s))
        return seen


class OneBuffer(Witness):
    """Shows every step in the same arrays, and gives its state in the same one."""

    def __init__(self, steps: int = 12) -> None:
        super().__init__(steps)
        self._pixels = np.zeros((64, 64, 3), np.uint8)
        self._seen = np.zeros(2, np.float32)
        self._told = np.zeros(2)

    def state(self):
        self._told[:] = super().state()
        return self._told

    def _shown(self, seen: Observation) -> Observation:
        super()._shown(seen)
        self._pixels[:] = seen.images["above"]
        self._seen[:] = seen.features
        return Observation({"above": self._pixels}, self._seen, seen.time_s)


class Straight:
    """A policy that goes straight on, and now and then a step aside."""

    def reset(self, rng: np.random.Generator) -> None:
        self.rng = rng

    def propose(self, observations: Observations) -> Proposal:
        del observations
        return Proposal(CHOICES[self.rng.integers(3)][None])


class OneActionBuffer(Straight):
    """Proposes in one array, and changes what it proposed before at each look."""

    def reset(self, rng: np.random.Generator) -> None:
        super().reset(rng)
        self._buffer = np.zeros((1, 1), np.float32)

    def propose(self, observations: Observations) -> Proposal:
        self._buffer[:] = super().propose(observations).actions
        return Proposal(self._buffer)


class Scribbling(Straight):
    """Writes into what it is shown, as one that normalises in place does."""

    def propose(self, observations: Observations) -> Proposal:
        for image in observations.images.values():
            image[:] = 0
        observations.features[:] = 0
        return super().propose(observations)


class Meddling:
    """A gate that puts another action into the proposal that it has judged."""

    def __init__(self, gate: Any) -> None:
        self.gate = gate

    def reset(self, rng: np.random.Generator) -> None:
        self.gate.reset(rng)

    def decide(self, observation: Observation, proposal: Proposal | None) -> Any:
        decision = self.gate.decide(observation, proposal)
        if proposal is not None:
            proposal.now[:] = 99
        return decision


class OneActionExpert:
    """Acts as another expert, in one array that it changes at each step."""

    def __init__(self, expert: Any) -> None:
        self.expert = expert
        self._buffer = np.zeros(1, np.float32)

    def reset(self) -> None:
        self.expert.reset()

    def act(self, observation: Observation) -> Action:
        self._buffer[:] = self.expert.act(observation)
        return self._buffer


class Onlooker:
    """A listener that does nothing."""

    def __init__(self) -> None:
        self.heard: list[str] = []

    def on_fit(self, states: Any) -> None:
        del states

    def on_start(self, environment: Any, info: Any) -> None:
        del environment, info
        self.heard.append("start")

    def on_step(self, environment: Any, step: Any) -> None:
        del environment, step
        self.heard.append("step")

    def on_end(self, episode: Any) -> None:
        del episode
        self.heard.append("end")


class ScribblingListener(Onlooker):
    """Writes into every array of the step that it is told of."""

    def on_step(self, environment: Any, step: Any) -> None:
        super().on_step(environment, step)
        for array in (step.state, step.executed, step.observation.features):
            array[:] = 7


@contextmanager
def lines() -> Iterator[list[str]]:
    """Collect the lines that a run prints of what broke down."""
    told: list[str] = []
    loggers = (audience.logger, telling.logger)

    def keep(record: Any) -> bool:
        told.append(record.getMessage())
        return False

    for logger in loggers:
        logger.addFilter(keep)
    try:
        yield told
    finally:
        for logger in loggers:
            logger.removeFilter(keep)
