"""What learning may ask of the expert, and what it must not cost: the same bars for every task."""

from functools import partial

from sheath_manip.experiments.claims import Claim, Summary, constant
from sheath_manip.experiments.measures import (
    ALL_LABELS,
    GATED,
    OWN_LABELS,
    executed_failures,
    last_round,
    near_the_experts,
    of_the_last_round,
)


def share_of_daggers_labels(summary: Summary) -> float:
    """Return the labels an episode with the expert's own steps alone, as a share of DAgger's."""
    own, all_of_them = (
        summary["methods"][name]["overall"]["labels_an_episode"]
        for name in (OWN_LABELS, ALL_LABELS)
    )
    return own / all_of_them


def failures_alone(end: int, method: str, summary: Summary) -> float:
    """Return an end of the 95 % interval, 0 the lower, of how often the last policy fails alone."""
    return last_round(method, summary)["policy"]["ci95"]["failure_rate"][end]


CLAIMS = (
    Claim(
        "SHEATH's executed failure rate, 1.5 times the expert's and 2 points",
        partial(executed_failures, GATED),
        "<=",
        near_the_experts,
    ),
    Claim(
        "expert's share in the last round",
        partial(of_the_last_round, "expert_share"),
        "<=",
        partial(constant, 0.08),
    ),
    Claim(
        "requests an episode in the last round",
        partial(of_the_last_round, "takeovers_an_episode"),
        "<=",
        partial(constant, 2),
    ),
    Claim(
        "requests a minute in the last round",
        partial(of_the_last_round, "takeovers_a_minute"),
        "<=",
        partial(constant, 4),
    ),
    Claim(
        "labels with own labels, a share of DAgger's",
        share_of_daggers_labels,
        "<=",
        partial(constant, 0.25),
    ),
    Claim(
        "last policy alone with own labels fails, low end of the interval; DAgger's high end",
        partial(failures_alone, 0, OWN_LABELS),
        "<=",
        partial(failures_alone, 1, ALL_LABELS),
    ),
)
