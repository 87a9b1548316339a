"""An environment and a policy for the one control loop, where somebody else's loop steps."""

from typing import Any

import gymnasium
import numpy as np

from sheath_manip.adapters.task_env import TaskEnv
from sheath_manip.adapters.task_spaces import TaskSpaces
from sheath_manip.protocols import Holds, PredictingPolicy
from sheath_manip.types import (
    Action,
    Observation,
    Observations,
    Outcome,
    Proposal,
    TaskSpec,
    Transition,
)


class HandedPolicy:
    """A policy that proposes what it was handed, an action of the space or a Proposal."""

    def __init__(self, spaces: TaskSpaces, looks: PredictingPolicy | None) -> None:
        self.spaces = spaces
        self.looks = looks
        self.handed: Any = None

    def reset(self, rng: np.random.Generator) -> None:
        """Begin an episode."""
        if self.looks is not None:
            self.looks.reset(rng)

    def propose(self, observations: Observations) -> Proposal:
        """Return it; raises ActionError where it is no action of the space."""
        handed, self.handed = self.handed, None
        if isinstance(handed, Proposal):
            return handed
        action = self.spaces.taken(handed)
        latents = {} if self.looks is None else self.looks.predict(observations).latents
        return Proposal(action[None], latents)


class SteppedEnvironment:
    """A wrapped environment of a task as the loop asks it, through all wrappers in between."""

    def __init__(self, env: gymnasium.Env, inside: TaskEnv) -> None:
        """Store both; `inside` is the innermost of `env`."""
        self.env = env
        self.inside = inside
        self.asked: dict[str, Any] = {}
        """the arguments of the next `reset`"""
        self.seen: Any = None
        """what the wrappers show"""
        self.info: dict[str, Any] = {}
        self.reward = 0.0

    @property
    def spec(self) -> TaskSpec:
        """The task's constant description."""
        return self.inside.task_spec

    def reset(self, seed: int) -> Observation:
        """Start the episode that was asked for, whose scene is `seed`."""
        del seed
        self.seen, self.info = self.env.reset(**self.asked)
        return self.inside.present

    def step(self, action: Action) -> Transition:
        """Run one control step; wrappers may have changed its reward and its end."""
        shown = self.inside.spaces.shown(action)
        self.seen, reward, terminated, truncated, self.info = self.env.step(shown)
        self.reward = float(reward)
        made = self.inside.transition
        assert made is not None
        return Transition(
            made.observation, self.reward, bool(terminated), bool(truncated), made.commanded
        )

    def outcome(self) -> Outcome:
        """Return how the episode stands."""
        return self.inside.environment.outcome()

    def metrics(self) -> Any:
        """Return the episode's figures so far."""
        return self.inside.environment.metrics()

    def hold(self) -> None:
        """Let the environment bring its robot to rest, where it can."""
        if isinstance(self.inside.environment, Holds):
            self.inside.environment.hold()

    def close(self) -> None:
        """Close all of it."""
        self.env.close()
