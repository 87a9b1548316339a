"""What is claimed of `results/gauze-cutting`."""

from functools import partial

from sheath_manip.experiments.claims import Claim, Summary, constant
from sheath_manip.experiments.measures import (
    executed_failures,
    executed_failures_at_random,
    training_seeds,
    wall_minutes,
)


def freed_alone(method: str, summary: Summary) -> float:
    """Share of discs that the method's last policies free alone, of the final scenes."""
    return summary["methods"][method]["final"]["metric"]["freed"]


def overlap_of_freed(method: str, summary: Summary) -> float:
    """Mean intersection over union of those discs; of a sheet that frees none it is 0."""
    metric = summary["methods"][method]["final"]["metric"]
    return metric["iou"] / metric["freed"] if metric["freed"] > 0 else 0.0


def freed_by_registered(summary: Summary) -> float:
    """Share of discs that the open loop along the circle as it lay at the start frees."""
    return summary["references"]["registered"]["metric"]["freed"]


CLAIMS = (
    Claim("training seeds", training_seeds, ">=", partial(constant, 3)),
    Claim("wall time, minutes", wall_minutes, "<=", partial(constant, 100)),
    Claim(
        "sheets that SHEATH ruins",
        partial(executed_failures, "sheath"),
        "<=",
        partial(constant, 0.03),
    ),
    Claim(
        "sheets that SHEATH ruins, those of DAgger",
        partial(executed_failures, "sheath"),
        "<",
        partial(executed_failures, "dagger"),
    ),
    Claim(
        "sheets that SHEATH ruins, those of takeovers at random",
        partial(executed_failures, "sheath"),
        "<",
        executed_failures_at_random,
    ),
    Claim(
        "discs that SHEATH's final policy frees alone",
        partial(freed_alone, "sheath"),
        ">=",
        partial(constant, 0.8),
    ),
    Claim(
        "discs that SHEATH's final policy frees alone, those of the registered open loop",
        partial(freed_alone, "sheath"),
        ">",
        freed_by_registered,
    ),
    Claim("IoU of those discs", partial(overlap_of_freed, "sheath"), ">=", partial(constant, 0.95)),
)
