"""What learning may ask of the expert, and what it must not cost: the same bars for every task."""

from collections.abc import Mapping
from functools import partial
from typing import Any

from sheath_manip.experiments.claims import Claim, Summary, constant

GATED, OWN_LABELS, ALL_LABELS = "sheath", "sheath-own-labels", "dagger"


def executed_failures(summary: Summary) -> float:
    """Return the share of the gated policy's episodes, over all rounds, that failed."""
    return summary["methods"][GATED]["overall"]["failure_rate"]


def near_the_experts(summary: Summary) -> float:
    """Return one and a half times the expert's own rate of failures, and two points."""
    return 1.5 * summary["expert"]["failure_rate"] + 0.02


def of_the_last_round(name: str, summary: Summary) -> float:
    """Return a figure of the gated policy's last round."""
    return _last(summary, GATED)[name]


def share_of_daggers_labels(summary: Summary) -> float:
    """Return the labels an episode with the expert's own steps alone, as a share of DAgger's."""
    own, all_of_them = (
        summary["methods"][name]["overall"]["labels_an_episode"]
        for name in (OWN_LABELS, ALL_LABELS)
    )
    return own / all_of_them


def failures_alone(bound: int, method: str, summary: Summary) -> float:
    """Return an end of the 95 % interval, 0 the lower, of how often the last policy fails alone."""
    return _last(summary, method)["policy"]["ci95"]["failure_rate"][bound]


CLAIMS = (
    Claim(
        "SHEATH's executed failure rate, near the expert's",
        executed_failures,
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
        "last policy alone with own labels, its interval's low end, DAgger's high",
        partial(failures_alone, 0, OWN_LABELS),
        "<=",
        partial(failures_alone, 1, ALL_LABELS),
    ),
)


def _last(summary: Summary, method: str) -> Mapping[str, Any]:
    return summary["methods"][method]["rounds"][-1]
