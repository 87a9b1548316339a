"""What is claimed of `results/platformer`."""

from functools import partial

import numpy as np

from sheath_manip.experiments.claims import Claim, Summary, constant
from sheath_manip.experiments.measures import rounds, training_seeds

CONVERGED_ROUNDS = 3
"""the last so many: where a policy is by then, less what one round more or less does to it"""


def executed_tiles(method: str, summary: Summary) -> float:
    """Mean distance of all episodes while learning, over all rounds and stages."""
    return summary["methods"][method]["overall"]["metric"]["distance_tiles"]


def daggers_converged_tiles(summary: Summary) -> float:
    """Return what DAgger's policy comes to: its mean distance alone over the last rounds."""
    rounds = summary["methods"]["dagger"]["rounds"][-CONVERGED_ROUNDS:]
    return float(np.mean([entry["policy"]["metric"]["distance_tiles"] for entry in rounds]))


def most_of_the_experts(summary: Summary) -> float:
    """Return 90 % of the expert's mean distance."""
    return 0.9 * summary["expert"]["metric"]["distance_tiles"]


def expert_progress(summary: Summary) -> float:
    """Share of the way to the flag that the expert comes alone."""
    return summary["expert"]["metric"]["progress"]


def more_area_than_dagger(method: str, summary: Summary) -> float:
    """Tiles by which its policies alone go farther than DAgger's, mean over rounds and stages.

    Its 95 % interval over stages is in the summary, beside the mean.
    """
    return summary["methods"][method]["area"]["policy"]["minus_dagger"]["mean"]


def queries(method: str, summary: Summary) -> float:
    """Labels asked for in all rounds of a training run, its demonstrations left out."""
    return summary["methods"][method]["overall"]["queries"]


def few_of_daggers_queries(summary: Summary) -> float:
    """Return 30 % of DAgger's queries."""
    return 0.3 * queries("dagger", summary)


CLAIMS = (
    Claim("stages, a training run each", training_seeds, ">=", partial(constant, 50)),
    Claim("rounds", rounds, ">=", partial(constant, 10)),
    Claim("expert's progress", expert_progress, ">=", partial(constant, 0.97)),
    Claim(
        "SHEATH's executed tiles in all rounds, DAgger's policy in its last three",
        partial(executed_tiles, "sheath"),
        ">=",
        daggers_converged_tiles,
    ),
    Claim(
        "SHEATH's executed tiles in all rounds, 90 % of the expert's",
        partial(executed_tiles, "sheath"),
        ">=",
        most_of_the_experts,
    ),
    Claim(
        "area under the curve of SHEATH's policy, tiles more than DAgger's",
        partial(more_area_than_dagger, "sheath"),
        ">=",
        partial(constant, 0),
    ),
    Claim(
        "the same with own labels",
        partial(more_area_than_dagger, "sheath-own-labels"),
        ">=",
        partial(constant, 0),
    ),
    Claim(
        "labels asked by SHEATH with own labels, 30 % of DAgger's",
        partial(queries, "sheath-own-labels"),
        "<=",
        few_of_daggers_queries,
    ),
)
