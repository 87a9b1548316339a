"""The figures of an episode so far."""

from dataclasses import dataclass

from sheath_manip.types import Outcome


@dataclass
class Tally:
    """What is remembered of an episode beside MuJoCo's state."""

    outcome: Outcome = Outcome.TIME_LIMIT
    lifted_steps: int = 0
    toppled: int = 0
    tilt_rad: float = 0.0
    """the largest of any object so far"""
    path_m: float = 0.0
    """that the tool has covered"""
    impulse_n_s: float = 0.0
    """the largest change of a clutter object's momentum in a control step: how hard it was hit"""
