"""A gymnasium environment as ours: episodes by seed, judged, with a time limit."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import gymnasium
import numpy as np

from sheath_manip.adapters.action_space import ActionLayout
from sheath_manip.adapters.judging import Judging, Moment
from sheath_manip.adapters.observation_space import ObservationLayout
from sheath_manip.types import Action, Observation, Outcome, TaskSpec, Transition


@dataclass(frozen=True)
class Terms:
    """How an environment is to be understood."""

    spec: TaskSpec
    observations: ObservationLayout
    actions: ActionLayout
    judge: Judging
    success_steps: int
    """in a row after which an episode ends as a success"""
    render: str
    """name of the camera that is what it renders; empty for none"""


class GymnasiumEnvironment:
    """Runs `gym` on those terms. An end of it that is no success and no failure is a time limit."""

    def __init__(self, gym: gymnasium.Env, terms: Terms) -> None:
        self.gym = gym
        self.terms = terms
        self.seen: Any = None
        """the latest observation as gymnasium has it, for experts"""
        self._steps, self._outcome, self._successes, self._return = 0, Outcome.TIME_LIMIT, 0, 0.0

    @property
    def spec(self) -> TaskSpec:
        """The task's constant description."""
        return self.terms.spec

    def reset(self, seed: int) -> Observation:
        """Start the episode that belongs to `seed`."""
        self._steps, self._outcome, self._successes, self._return = 0, Outcome.TIME_LIMIT, 0, 0.0
        self.seen, _ = self.gym.reset(seed=int(seed))
        return self._observed()

    def step(self, action: Action) -> Transition:
        """Run one control step; raises ActionError for an action outside the spec."""
        given = self.terms.actions.given(self.spec.action.validated(action))
        self.seen, reward, terminated, truncated, info = self.gym.step(given)
        moment = Moment(self.seen, float(reward), bool(terminated), bool(truncated), info)
        self._steps += 1
        self._return += moment.reward
        judged = self.terms.judge(moment)
        self._successes = self._successes + 1 if judged is Outcome.SUCCESS else 0
        over = moment.terminated or moment.truncated or self._steps >= self.spec.max_steps
        held = self._successes >= self.terms.success_steps
        if over or held or judged is Outcome.FAILURE:
            # One lucky step at the time limit is not what lasted.
            lucky = judged is Outcome.SUCCESS and not (held or moment.terminated)
            self._outcome = Outcome.TIME_LIMIT if lucky else judged
        decided = self._outcome is not Outcome.TIME_LIMIT
        return Transition(self._observed(), moment.reward, decided, over and not decided)

    def outcome(self) -> Outcome:
        """Return how the episode stands."""
        return self._outcome

    def metrics(self) -> Mapping[str, float]:
        """Whether it is a success, and the sum of its rewards."""
        return {"success": float(self._outcome is Outcome.SUCCESS), "return": self._return}

    def close(self) -> None:
        """Close the other one."""
        self.gym.close()

    def _observed(self) -> Observation:
        terms = self.terms
        images = {terms.render: np.asarray(self.gym.render())} if terms.render else {}
        time_s = self._steps / terms.spec.control_rate_hz
        return terms.observations.observed(self.seen, time_s, images)
