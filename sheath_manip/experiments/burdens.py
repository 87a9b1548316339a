"""Burdens as a summary has them, also one that was written before they were counted.

What an older summary does not hold follows from what it does: a takeover is two changes of who
acts, an episode's steps are the round's horizon. Where that is not enough, such as for a time
without a control rate, there is None.
"""

from collections.abc import Mapping, Sequence
from typing import Any

from sheath_manip.burden import MINUTE_S

Entry = Mapping[str, Any]
Burdens = dict[str, float | None]
"""by the fields of `Burden`, and `driving_steps_an_episode`"""

STEPS = "driving_steps_an_episode"


def overall_burdens(method: Entry, control_rate_hz: float | None = None) -> Burdens:
    """Return the burdens of a method over all its rounds of learning.

    Args:
        method: of a summary's `methods`.
        control_rate_hz: of the task; only a summary that does not hold it needs it.
    """
    learning = [entry for entry in method["rounds"] if entry["round"] > 0]
    steps = _mean([entry["horizon"] for entry in learning])
    runs = _mean([entry["runs"] for entry in learning])
    return _burdens(method["overall"], method["overall"], steps, runs, control_rate_hz)


def round_burdens(entry: Entry, control_rate_hz: float | None = None) -> Burdens:
    """Return the burdens of one round; of the demonstrations, where no policy drives, no takeover.

    Args:
        entry: of a method's `rounds`.
        control_rate_hz: as for `overall_burdens`.
    """
    found = _burdens(entry, entry["executed"], entry["horizon"], entry["runs"], control_rate_hz)
    return found if entry["round"] else {**found, "takeovers_an_episode": 0.0}


def _burdens(
    entry: Entry, figures: Entry, steps: float | None, runs: float | None, rate_hz: float | None
) -> Burdens:
    share = entry["expert_share"]
    driving_steps = None if None in (share, steps) else share * steps
    told = {STEPS: driving_steps}
    if "takeovers_an_episode" in entry:
        return told | {name: entry[name] for name in NAMES}
    takeovers = 1.0 if share == 1.0 else entry["switches_per_episode"] / 2
    labels = None if not runs else entry["queries"] * runs / figures["episodes"]
    derived: Burdens = {
        "takeovers_an_episode": takeovers,
        "takeovers_a_minute": None,
        "median_takeover_s": None,
        "driving_s_an_episode": None,
        "labels_an_episode": labels,
    }
    if rate_hz and steps:
        derived["takeovers_a_minute"] = takeovers * MINUTE_S * rate_hz / steps
        derived["driving_s_an_episode"] = None if driving_steps is None else driving_steps / rate_hz
    return told | derived


NAMES = (
    "takeovers_an_episode",
    "takeovers_a_minute",
    "median_takeover_s",
    "driving_s_an_episode",
    "labels_an_episode",
)


def _mean(values: Sequence[float | None]) -> float | None:
    known = [value for value in values if value is not None]
    return sum(known) / len(known) if known else None
