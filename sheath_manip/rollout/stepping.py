"""The steps of an episode as they come: made in the environment, kept, and told of."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from sheath_manip.rollout.audience import Audience
from sheath_manip.rollout.stage import Stage
from sheath_manip.rollout.telling import Telling
from sheath_manip.types import (
    Action,
    Actor,
    Breakdown,
    Commanded,
    Episode,
    EpisodeInfo,
    GateDecision,
    Observation,
    Outcome,
    Step,
)


class Stepping:
    """Runs control steps and keeps them; nothing of what is kept can be changed from outside."""

    def __init__(self, stage: Stage, audience: Audience, telling: Telling) -> None:
        self.stage = stage
        self.audience = audience
        self.steps: list[Step] = []
        self.terminated = False
        self.truncated = False
        self.telling = telling
        self.moved = False
        """whether the robot was commanded anything yet"""
        self._observation: Observation | None = None
        self._state: NDArray[np.float64] | None = None

    def begin(self, seed: int, state: NDArray[np.float64] | None = None) -> None:
        """Start the episode, or go on from `state`; raises BrokenError, as all here does."""
        self._observation = self.stage.reset(seed)
        if state is not None:
            self._observation = self.stage.restore(state)

    @property
    def over(self) -> bool:
        """Whether the environment has ended the episode."""
        return self.terminated or self.truncated

    def look(self) -> Observation:
        """Return what is seen before the next action; it is a new step from here on."""
        assert self._observation is not None, "begin comes before look"
        # None until it is read: what a state was before must not pass for what it is.
        self._state = None
        self._state = self.stage.state()
        return self._observation

    def step(
        self, proposed: Action | None, labelled: Action | None, decision: GateDecision
    ) -> None:
        """Make the step that was looked at: by the policy's action, or by whose turn it is."""
        observation, state = self._observation, self._state
        requested = proposed if decision.actor is Actor.POLICY else labelled
        assert observation is not None
        assert state is not None
        assert requested is not None
        if decision.broken:
            self.telling.tell(len(self.steps), decision)
        self.moved = True
        transition = self.stage.step(requested)
        commanded = transition.commanded or Commanded(requested)
        step = Step(
            observation,
            state,
            proposed,
            labelled,
            decision,
            commanded.action,
            transition.reward,
            commanded.limited,
        )
        self.steps.append(step)
        self._observation, self._state = transition.observation, None
        self.terminated, self.truncated = transition.terminated, transition.truncated
        self.audience.step(self.stage.environment, step)

    def episode(
        self,
        info: EpisodeInfo,
        outcome: Outcome,
        metrics: Mapping[str, float],
        cut_short_by: Breakdown | None = None,
    ) -> Episode:
        """Return the steps so far as an episode; of one cut short the state may be unknown."""
        assert self._observation is not None
        if cut_short_by is None:
            final_state = self.stage.state()
        else:
            final_state = self._state
            if final_state is None:
                final_state = np.full_like(self.steps[-1].state, np.nan)
        return Episode(
            info,
            tuple(self.steps),
            self._observation,
            final_state,
            self.terminated,
            self.truncated,
            outcome,
            metrics,
            cut_short_by,
        )
