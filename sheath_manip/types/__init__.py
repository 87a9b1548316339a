"""The small frozen values that cross every boundary of the framework."""

from sheath_manip.types.episode import Episode, EpisodeInfo, Outcome, Purpose
from sheath_manip.types.scene import Line, SceneGeom, ScenePose, Surface
from sheath_manip.types.spec import Action, ActionSpec, FirstView, Mirror, TaskSpec, ToolFrame
from sheath_manip.types.step import (
    Actor,
    Commanded,
    GateDecision,
    Limited,
    Observation,
    Reason,
    Step,
    Transition,
)

__all__ = [
    "Action",
    "ActionSpec",
    "Actor",
    "Commanded",
    "Episode",
    "EpisodeInfo",
    "FirstView",
    "GateDecision",
    "Limited",
    "Line",
    "Mirror",
    "Observation",
    "Outcome",
    "Purpose",
    "Reason",
    "SceneGeom",
    "ScenePose",
    "Step",
    "Surface",
    "TaskSpec",
    "ToolFrame",
    "Transition",
]
