"""What a task can put before a gate to see whether it notices."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from sheath_manip.experiments.claims import Claim
from sheath_manip.types import Action, Observation


@dataclass(frozen=True)
class Displacement:
    """Takes the robot from a state of the expert's to one that may be no state of any expert."""

    name: str
    apply: Callable[[Any, np.random.Generator], Observation]
    """changes the environment's present state and looks; the caller restores it"""
    far: bool = True
    """whether no expert ever comes there, so that a gate must be outside"""


@dataclass(frozen=True)
class Probes:
    """A task's displaced states, and what it takes for a mistake. Everything can be pickled."""

    displacements: Sequence[Displacement]
    regret: Callable[[Any, Action], float]
    """from the expert and an action: how much dearer than the best one it is, now"""
    costly_regret: float
    """beyond which an action is a costly mistake"""
    claims: Sequence[Claim] = ()
    """what is claimed of this task's gates in the experiment `gates`"""
