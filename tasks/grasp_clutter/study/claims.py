"""What is claimed of `results/grasp-clutter`."""

from functools import partial

from sheath_manip.experiments.asked_claims import CLAIMS as ASKED
from sheath_manip.experiments.claims import Claim, Summary, constant
from sheath_manip.experiments.measures import (
    executed_failures,
    final_scenes,
    of_the_last_round,
    rounds,
    training_seeds,
    wall_minutes,
)


def success_alone(method: str, summary: Summary) -> float:
    """Return the success of the method's last policies alone, on the final held-out scenes."""
    return summary["methods"][method]["final"]["success_rate"]


def success_gained(method: str, summary: Summary) -> float:
    """Return what the last policies alone succeed more often than the first, on the same scenes."""
    rounds = summary["methods"][method]["rounds"]
    first, last = (entry["policy"]["success_rate"] for entry in (rounds[0], rounds[-1]))
    return last - first


def demonstrations(summary: Summary) -> float:
    """Clean ones, that all methods start from."""
    plan = summary["plan"]["schedule"]
    return plan["demonstrations"] if plan["demonstration_noise"] == 0 else float("nan")


CLAIMS = (
    Claim("training seeds", training_seeds, ">=", partial(constant, 3)),
    Claim("clean demonstrations", demonstrations, "<=", partial(constant, 60)),
    Claim("rounds", rounds, ">=", partial(constant, 5)),
    Claim("held-out scenes of each final policy", final_scenes, ">=", partial(constant, 100)),
    Claim("wall time, minutes", wall_minutes, "<=", partial(constant, 100)),
    Claim(
        "share of SHEATH's executed episodes that topple something",
        partial(executed_failures, "sheath"),
        "<=",
        partial(constant, 0.03),
    ),
    Claim(
        "SHEATH's expert share in the last round",
        partial(of_the_last_round, "expert_share"),
        "<=",
        partial(constant, 0.35),
    ),
    Claim(
        "success of SHEATH's final policy alone",
        partial(success_alone, "sheath"),
        ">=",
        partial(constant, 0.85),
    ),
    Claim(
        "success that DAgger's policy alone gains over cloning",
        partial(success_gained, "dagger"),
        ">",
        partial(constant, 0),
    ),
)


HARD = (
    Claim("training seeds", training_seeds, ">=", partial(constant, 3)),
    Claim("clean demonstrations", demonstrations, "<=", partial(constant, 60)),
    Claim("held-out scenes of each final policy", final_scenes, ">=", partial(constant, 100)),
    *ASKED,
)
"""of `results/grasp-clutter-hard`"""
RECIPE = (
    Claim("held-out scenes", final_scenes, ">=", partial(constant, 100)),
    Claim(
        "success of the recipe's policy alone",
        partial(success_alone, "cloning"),
        ">=",
        partial(constant, 0.93),
    ),
)
"""of `results/grasp-clutter-recipe`"""
