"""What an experiment found, in one sentence each: the titles of its figures, from its numbers."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from sheath_manip.experiments.burdens import overall_burdens
from sheath_manip.experiments.figures.style import drawn_methods
from sheath_manip.playback.written import in_percent, rounded, shown

OVERALL, FINAL = "overall", "final"
OURS, THEIRS = "sheath", "dagger"
"""what a title is about, and what it is held against"""


def failures(summary: Mapping[str, Any]) -> str:
    """Return how often robots failed while they learned."""
    methods = summary["methods"]
    name, other = _compared(methods)
    first = methods[name]["overall"]
    said = f"{shown(name)}'s robot failed in {_failed(first)} of {first['episodes']:,} episodes"
    if other is None:
        return f"{said} while learning"
    second = methods[other]["overall"]
    same = second["episodes"] == first["episodes"]
    of = "" if same else f" of {second['episodes']:,}"
    return f"{said} while learning, {shown(other)}'s in {_failed(second)}{of}"


def burden(summary: Mapping[str, Any]) -> str:
    """Return how much the expert had to do."""
    name, _ = _compared(summary["methods"])
    method = summary["methods"][name]
    burdens = overall_burdens(method, summary.get("control_rate_hz"))
    takeovers, a_minute = burdens["takeovers_an_episode"] or 0.0, burdens["takeovers_a_minute"]
    often = "" if a_minute is None else f" ({rounded(a_minute)} a minute)"
    share = in_percent(method["overall"]["expert_share"])
    return (
        f"{shown(name)}'s expert takes over {rounded(takeovers)} times an episode{often} and "
        f"drives in {share} of the steps"
    )


def bound(summary: Mapping[str, Any]) -> str:
    """Return in how many rounds the measured mistakes stayed below their bound."""
    held = [
        entry["measured"] <= entry["bound"]
        for name in drawn_methods(summary["methods"])
        for entry in summary["methods"][name]["rounds"]
        if entry["round"] > 0 and None not in (entry["measured"], entry["bound"])
    ]
    return f"Mistakes stayed within their bound T (ε + ξ) in {sum(held)} of {len(held)} rounds"


def rates(summary: Mapping[str, Any]) -> str:
    """Return in what share of the episodes robots failed while they learned.

    Where the expert alone drove, in what share of the final scenes the last policy failed.
    """
    methods = summary["methods"]
    name, other = _compared(methods)
    first = in_percent(methods[name][talked_about(summary)]["failure_rate"])
    if talked_about(summary) == FINAL:
        return f"{shown(name)}'s last policy fails in {first} of the final scenes"
    said = f"{shown(name)} fails in {first} of the episodes while learning"
    if other is None:
        return said
    return f"{said}, {shown(other)} in {in_percent(methods[other]['overall']['failure_rate'])}"


def talked_about(summary: Mapping[str, Any]) -> str:
    """Return where a method has the figures that matter most: `overall`, or `final`."""
    only_expert = all(
        method["overall"]["expert_share"] == 1 for method in summary["methods"].values()
    )
    return FINAL if only_expert else OVERALL


def _compared(methods: Mapping[str, Any]) -> tuple[str, str | None]:
    """The method that a title is about, and the one beside it."""
    drawn = drawn_methods(methods)
    name = OURS if OURS in drawn else drawn[0]
    others = [each for each in (THEIRS, *drawn) if each in drawn and each != name]
    return name, others[0] if others else None


def _failed(figures: Mapping[str, Any]) -> int:
    return int(np.rint(figures["failure_rate"] * figures["episodes"]))
