"""An environment whose episodes a person may end."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sheath_manip.cockpit.cockpit import Cockpit
from sheath_manip.cockpit.standing import Ending
from sheath_manip.cockpit.unattended import require_attended
from sheath_manip.protocols import Environment, Holds, Restorable, Viewable
from sheath_manip.rollout.discarding import DiscardedError
from sheath_manip.types import (
    Action,
    Actor,
    Observation,
    Outcome,
    TaskSpec,
    Transition,
)


class OperatedEnvironment:
    """The environment that it is given, until the person says that the episode is over.

    It stands still where the run is stopped or abandoned and the episode's gate does not see to
    that: that of a policy on its own, or of a scripted expert, knows no person.
    """

    def __init__(self, environment: Environment, cockpit: Cockpit) -> None:
        self.environment = environment
        self.cockpit = cockpit
        self._observation: Observation | None = None
        # Attributes of the instance, so that this one has just what the other has.
        if isinstance(environment, Restorable):
            self.state, self.restore = environment.state, self._restore
        if isinstance(environment, Viewable):
            self.scene = environment.scene
            self.pose, self.pose_at = environment.pose, environment.pose_at

    @property
    def spec(self) -> TaskSpec:
        """The task's constant description."""
        return self.environment.spec

    def reset(self, seed: int) -> Observation:
        """Start the episode that belongs to `seed`."""
        self.cockpit.begin_episode()
        self._observation = self.environment.reset(seed)
        return self._observation

    def step(self, action: Action) -> Transition:
        """Run one control step, none where nothing may move and the episode is over.

        Raises DiscardedError where the person wants no more of it, and UnattendedError where it may
        not go on and nobody is left to say when.
        """
        if not self.cockpit.gated:
            self._stand_still()
        self._require_kept()
        if self.cockpit.still:
            assert self._observation is not None, "reset comes before step"
            transition = Transition(self._observation, 0.0, terminated=False, truncated=True)
        else:
            transition = self.environment.step(action)
        self._observation = transition.observation
        if transition.terminated or transition.truncated:
            # The episode's own end does not record what is about to be discarded.
            if self.cockpit.discarding:
                self.hold()
            while self.cockpit.discarding and not self.cockpit.closed:
                self.cockpit.rest()
            self._require_kept(discarding=self.cockpit.discarding)
        if self.cockpit.ending is None or transition.terminated:
            return transition
        marked = self.cockpit.mark is not None
        return replace(transition, terminated=marked, truncated=not marked)

    def _require_kept(self, discarding: bool = False) -> None:
        if discarding or self.cockpit.ending is Ending.DISCARD:
            raise DiscardedError("the person has discarded the episode")

    def _stand_still(self) -> None:
        cockpit, now = self.cockpit, self.cockpit.now()
        if (now.halted or now.abandoned) and now.ending is None:
            self.hold()
        while (now.halted or now.abandoned) and now.ending is None:
            cockpit.give_turn(Actor.HOLD, not now.halted, float("inf"), still=True)
            require_attended(now)
            cockpit.rest()
            now = cockpit.now()
        blocked = now.halted or now.abandoned
        cockpit.give_turn(Actor.HOLD if blocked else Actor.POLICY, still=blocked)

    def hold(self) -> None:
        """Let the environment bring its robot to rest by itself, where it can."""
        if isinstance(self.environment, Holds):
            self.environment.hold()

    def outcome(self) -> Outcome:
        """Return the outcome that the person said, else the task."""
        return self.cockpit.mark or self.environment.outcome()

    def metrics(self) -> Mapping[str, float]:
        """The episode's figures so far."""
        return self.environment.metrics()

    def close(self) -> None:
        """Free what the simulator holds."""
        self.environment.close()

    def _restore(self, state: NDArray[np.float64]) -> Observation:
        assert isinstance(self.environment, Restorable)
        self._observation = self.environment.restore(state)
        return self._observation
