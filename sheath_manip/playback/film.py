"""One episode as a page shows it: every step, and how the scene stood after it."""

import numpy as np
from numpy.typing import NDArray

from sheath_manip.playback.trace import GrowingTrace
from sheath_manip.protocols import Environment, Viewable
from sheath_manip.types import (
    Episode,
    EpisodeInfo,
    Observation,
    Outcome,
    SceneGeom,
    ScenePose,
    Step,
)

NO_POSE = ScenePose(np.zeros((0, 7)))
"""of an environment that is not `Viewable`: of no body"""


class Film:
    """Grows while the episode runs, on one thread; others may look meanwhile."""

    def __init__(
        self,
        info: EpisodeInfo,
        scene: tuple[SceneGeom, ...],
        first_pose: ScenePose,
        lacks: str = "",
    ) -> None:
        """Begin with how the scene stands before the first step.

        `lacks` says in a line for a person why there is no scene; empty where there is one.
        """
        self.info = info
        self.scene = scene
        self.first_pose = first_pose
        self.lacks = lacks
        self.trace = GrowingTrace(info)
        self.steps: list[Step] = []
        self.poses: list[ScenePose] = []
        """after each step"""
        self.outcome: Outcome | None = None
        """None while the episode runs"""
        self._end: tuple[Observation, NDArray[np.float64]] | None = None

    def __len__(self) -> int:
        return len(self.poses)

    def observation(self, moment: int) -> Observation:
        """Return what is seen before a step, or at `len` after the last one of a whole episode."""
        return self._at_end()[0] if moment == len(self) else self.steps[moment].observation

    def state(self, moment: int) -> NDArray[np.float64]:
        """Return the environment's state at such a moment."""
        return self._at_end()[1] if moment == len(self) else self.steps[moment].state

    def end(self, episode: Episode) -> None:
        """Take note of how the episode ended, and of what is seen since."""
        self.outcome = episode.outcome
        self._end = episode.final_observation, episode.final_state

    def _at_end(self) -> tuple[Observation, NDArray[np.float64]]:
        if self._end is None:
            raise IndexError(f"{self.info.task}'s episode still runs; its last observation is open")
        return self._end

    def append(self, step: Step, pose: ScenePose) -> None:
        """Add one step and how the scene stands after it."""
        self.trace.append(step, pose)
        self.steps.append(step)
        self.poses.append(pose)


def film_begun(environment: Environment, info: EpisodeInfo) -> Film:
    """Return the film of an episode that begins in `environment`, without its steps."""
    if isinstance(environment, Viewable):
        return Film(info, tuple(environment.scene()), environment.pose())
    return Film(info, (), NO_POSE, _lacking(environment))


def pose_of(environment: Environment) -> ScenePose:
    """Return how the scene stands now, of no body where there is none to be seen."""
    return environment.pose() if isinstance(environment, Viewable) else NO_POSE


def film_of(environment: Environment, episode: Episode) -> Film:
    """A recorded `episode`, looked at in an `environment` of its task and variant."""
    environment.reset(episode.info.seed)
    states = [*(step.state for step in episode.steps), episode.final_state]
    if isinstance(environment, Viewable) and episode.final_state.size:
        first_pose = environment.pose_at(states[0])
        film = Film(episode.info, tuple(environment.scene()), first_pose)
        for step, state in zip(episode.steps, states[1:], strict=True):
            film.append(step, environment.pose_at(state))
    else:
        film = Film(episode.info, (), NO_POSE, _lacking(environment))
        for step in episode.steps:
            film.append(step, NO_POSE)
    film.end(episode)
    return film


def _lacking(environment: Environment) -> str:
    if isinstance(environment, Viewable):
        return "only what cameras saw is shown: the recording has no simulator states"
    name = type(environment).__name__
    return f"only what cameras saw is shown: {name} has no scene() and pose() for a 3-D view"
