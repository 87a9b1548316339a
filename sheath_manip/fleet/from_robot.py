"""What a robot's process says: how it stands, and its episode step by step."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sheath_manip.cockpit.question import Question
from sheath_manip.cockpit.state import State
from sheath_manip.types import Episode, EpisodeInfo, SceneGeom, ScenePose, Step


@dataclass(frozen=True, eq=False)
class Report:
    """How a robot stands; said on each change and again and again, so that silence tells."""

    at_s: float
    """by `time.monotonic`, one clock for all processes of a machine"""
    state: State
    still: bool
    tool_pose: NDArray[np.float64] | None


@dataclass(frozen=True, eq=False)
class Asked:
    """What its gate has just decided against; None: it lets the policy act."""

    question: Question | None


@dataclass(frozen=True, eq=False)
class Begun:
    """An episode begins, and how its scene stands before the first step."""

    info: EpisodeInfo
    scene: tuple[SceneGeom, ...]
    first_pose: ScenePose
    lacks: str
    """why there is no scene; empty where there is one"""


@dataclass(frozen=True, eq=False)
class Stepped:
    """A step was made, and how the scene stands after it."""

    step: Step
    pose: ScenePose


@dataclass(frozen=True, eq=False)
class Ended:
    """The episode is over, or was cut short."""

    episode: Episode


FromRobot = Report | Asked | Begun | Stepped | Ended
