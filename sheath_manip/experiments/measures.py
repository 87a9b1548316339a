"""Numbers of a learning experiment's summary that claims of several tasks are about."""

from collections.abc import Mapping
from typing import Any

from sheath_manip.experiments.claims import Summary, uninformed

GATED, OWN_LABELS, ALL_LABELS = "sheath", "sheath-own-labels", "dagger"


def training_seeds(summary: Summary) -> float:
    """Return how many training runs of each method there are."""
    return len(summary["seeds"])


def rounds(summary: Summary) -> float:
    """Return the number of rounds after the demonstrations."""
    return last_round(GATED, summary)["round"]


def evaluation_scenes(summary: Summary) -> float:
    """Return on how many scenes the policy alone is judged after each round."""
    return summary["plan"]["comparison"]["evaluation_episodes"]


def final_scenes(summary: Summary) -> float:
    """Return on how many held-out scenes each of the last policies is judged."""
    return summary["plan"]["comparison"]["final_episodes"]


def wall_minutes(summary: Summary) -> float:
    """Return the wall time of the experiment."""
    return summary["wall_s"] / 60


def wall_minutes_a_method(summary: Summary) -> float:
    """Return the wall time of the experiment, divided by the number of methods that it compares."""
    return wall_minutes(summary) / len(summary["methods"])


def experts_failures(summary: Summary) -> float:
    """Return the share of the episodes that the expert drove alone that failed."""
    return summary["expert"]["failure_rate"]


def near_the_experts(summary: Summary) -> float:
    """Return one and a half times the expert's own rate of failures, and two points."""
    return 1.5 * experts_failures(summary) + 0.02


def executed_failures(method: str, summary: Summary) -> float:
    """Return the share of a method's executed episodes, over all rounds and seeds, that failed."""
    return summary["methods"][method]["overall"]["failure_rate"]


def executed_failures_at_random(summary: Summary) -> float:
    """Return the same of takeovers at random with SHEATH's burden."""
    return executed_failures(uninformed(summary), summary)


def last_round(method: str, summary: Summary) -> Mapping[str, Any]:
    """Return all figures of a method's last round."""
    return summary["methods"][method]["rounds"][-1]


def of_the_last_round(name: str, summary: Summary) -> float:
    """Return a figure of SHEATH's last round, such as its `expert_share`."""
    return last_round(GATED, summary)[name]
