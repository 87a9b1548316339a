"""The small frozen values that cross every boundary of the framework."""

from sheath_manip.types.columns import ACTORS, REASONS, Columns
from sheath_manip.types.episode import Episode, EpisodeInfo, Outcome, Purpose
from sheath_manip.types.scene import CameraPose, Line, SceneGeom, ScenePose, Surface
from sheath_manip.types.spec import Action, ActionSpec, FirstView, Mirror, TaskSpec, ToolFrame
from sheath_manip.types.step import (
    Actor,
    Breakdown,
    Commanded,
    GateDecision,
    Judgement,
    Limited,
    Observation,
    Observations,
    Proposal,
    Reason,
    SignalScore,
    Step,
    Transition,
)

__all__ = [
    "ACTORS",
    "REASONS",
    "Action",
    "ActionSpec",
    "Actor",
    "Breakdown",
    "CameraPose",
    "Columns",
    "Commanded",
    "Episode",
    "EpisodeInfo",
    "FirstView",
    "GateDecision",
    "Judgement",
    "Limited",
    "Line",
    "Mirror",
    "Observation",
    "Observations",
    "Outcome",
    "Proposal",
    "Purpose",
    "Reason",
    "SceneGeom",
    "ScenePose",
    "SignalScore",
    "Step",
    "Surface",
    "TaskSpec",
    "ToolFrame",
    "Transition",
]
