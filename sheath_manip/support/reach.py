"""Whether anything scores below a threshold: a score with a floor may leave nothing there.

A sum of kernels falls to 0 far away and no further. A threshold that is calibrated on few episodes,
or on ones unlike the training states, may come to lie down there.
"""

import sys
import warnings

import numpy as np

from sheath_manip.exceptions import GateWarning

LEAST_SHARE = 0.25
"""of the way up from the score far away to 0, the support's own boundary. Thresholds from three
held-out laps lay at .59 and above on the embeddings by default, those from episodes that are alike
at .9 and above; at .16 a gate was seen that let every failure pass"""


def warn_out_of_reach(threshold: float, far_score: float, held_out: int) -> None:
    """Warn where only what is extremely unlike the training states can score below `threshold`.

    Args:
        threshold: below which the expert takes over.
        far_score: the score infinitely far from all training states, below 0; -inf where scores
            fall without bound, which is never warned of.
        held_out: the number of episodes that the threshold is from.
    """
    if not np.isfinite(far_score) or threshold - far_score > LEAST_SHARE * -far_score:
        return
    warnings.warn(
        f"this gate may never take over: its threshold is {threshold:.4g}, and even a state "
        f"infinitely far from all training states scores {far_score:.4g}; hold out more episodes "
        f"than {held_out} (10 or more, like those of the fit), or allow a higher rate of false "
        "alarms",
        GateWarning,
        stacklevel=_levels_up(),
    )


def _levels_up() -> int:
    """How far up the line is that asked for a gate: the first that is not of this package."""
    level, frame = 1, sys._getframe(1)
    while frame is not None and frame.f_globals.get("__name__", "").startswith("sheath_manip."):
        level, frame = level + 1, frame.f_back
    return level
