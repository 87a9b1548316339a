"""Learning from an expert under a gate; the names listed here are the public interface.

Each is imported when it is first asked for, so that `import sheath_manip` alone stays cheap. The
loop that drives an episode is `sheath_manip.rollout.rollout`; all other values that cross a
boundary are in `sheath_manip.types`.
"""

import os
import sys
from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sheath_manip.adapters.from_callable import from_callable
    from sheath_manip.adapters.from_torch import from_torch
    from sheath_manip.array_environment import ArrayEnvironment
    from sheath_manip.dataset.exchange.sources import import_data
    from sheath_manip.dataset.store import EpisodeStore
    from sheath_manip.exceptions import SheathError
    from sheath_manip.gates.config import GateConfig
    from sheath_manip.gates.fitted import Sources
    from sheath_manip.gates.support import SupportGate
    from sheath_manip.learning.checkpoint import Checkpoint, load_checkpoint
    from sheath_manip.learning.first_episodes import demonstrations, gated_episode
    from sheath_manip.learning.fitting import fit_gate
    from sheath_manip.learning.gate_file import load_gate
    from sheath_manip.playback.making import contact_sheet
    from sheath_manip.policies import make_policy
    from sheath_manip.protocols import Environment, Expert, Gate, Judge, Policy
    from sheath_manip.support.calibration import held_out_threshold
    from sheath_manip.support.one_class_svm import OneClassSupport
    from sheath_manip.task import Task
    from sheath_manip.types import (
        ActionSpec,
        Episode,
        EpisodeInfo,
        GateDecision,
        Judgement,
        Observation,
        Observations,
        Outcome,
        Proposal,
        Purpose,
        TaskSpec,
        Transition,
    )
    from sheath_manip.types.samples import Samples, samples_from

__all__ = [
    "ActionSpec",
    "ArrayEnvironment",
    "Checkpoint",
    "Environment",
    "Episode",
    "EpisodeInfo",
    "EpisodeStore",
    "Expert",
    "Gate",
    "GateConfig",
    "GateDecision",
    "Judge",
    "Judgement",
    "Observation",
    "Observations",
    "OneClassSupport",
    "Outcome",
    "Policy",
    "Proposal",
    "Purpose",
    "Samples",
    "SheathError",
    "Sources",
    "SupportGate",
    "Task",
    "TaskSpec",
    "Transition",
    "contact_sheet",
    "demonstrations",
    "fit_gate",
    "from_callable",
    "from_torch",
    "gated_episode",
    "held_out_threshold",
    "import_data",
    "load_checkpoint",
    "load_gate",
    "make_policy",
    "samples_from",
]

_HOMES = {
    "adapters.from_callable": ("from_callable",),
    "adapters.from_torch": ("from_torch",),
    "array_environment": ("ArrayEnvironment",),
    "dataset.exchange.sources": ("import_data",),
    "dataset.store": ("EpisodeStore",),
    "exceptions": ("SheathError",),
    "gates.config": ("GateConfig",),
    "gates.fitted": ("Sources",),
    "gates.support": ("SupportGate",),
    "learning.checkpoint": ("Checkpoint", "load_checkpoint"),
    "learning.first_episodes": ("demonstrations", "gated_episode"),
    "learning.fitting": ("fit_gate",),
    "learning.gate_file": ("load_gate",),
    "playback.making": ("contact_sheet",),
    "policies": ("make_policy",),
    "protocols": ("Environment", "Expert", "Gate", "Judge", "Policy"),
    "support.calibration": ("held_out_threshold",),
    "support.one_class_svm": ("OneClassSupport",),
    "task": ("Task",),
    "types": (
        "ActionSpec",
        "Episode",
        "EpisodeInfo",
        "GateDecision",
        "Judgement",
        "Observation",
        "Observations",
        "Outcome",
        "Proposal",
        "Purpose",
        "TaskSpec",
        "Transition",
    ),
    "types.samples": ("Samples", "samples_from"),
}
_HOME_OF = {name: home for home, names in _HOMES.items() for name in names}

# Before MuJoCo is first imported, which takes capitals and blanks where dm_control does not.
# Without a display it must be told to render off screen.
if sys.platform == "linux":
    _backend = os.environ.get("MUJOCO_GL", "").strip().lower()
    if not _backend and not os.environ.get("DISPLAY"):
        _backend = "egl"
    if _backend:
        os.environ["MUJOCO_GL"] = _backend


def __getattr__(name: str) -> Any:
    if name not in _HOME_OF:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    found = getattr(import_module(f"{__name__}.{_HOME_OF[name]}"), name)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
