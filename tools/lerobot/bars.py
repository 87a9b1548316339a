"""What is to be shown of LeRobot's policy under our gate, and whether it was."""

from typing import Any

METHODS = ("sheath", "random-takeover", "dagger")
"""in this order: random takeover is given SHEATH's share of the same round"""
MOST_APART = 2
"""successes of 40"""
MOST_OFF = 0.03
LEAST_SUCCESS = 0.60


def bars(results: dict[str, Any]) -> dict[str, bool]:
    """Return what was to be shown, as far as it can be told, and whether it was."""
    start, methods = results["start"], results["methods"]
    alone, judged, alarms = start["alone"], start["judged"], start["false_alarms"]
    ours = round(alone["success_rate"] * alone["episodes"])
    first = alone["success_rate"]
    last = {name: rounds[-1]["alone"]["success_rate"] for name, rounds in methods.items()}
    of_start = {
        "alone within 2 of LeRobot's own loop": abs(ours - start["lerobots_own_loop"]["successes"])
        <= MOST_APART,
        "the judged action is the given one": judged["judged_is_given"] == judged["policy_steps"],
        "one forward pass a chunk": start["forward_passes"] == start["chunks"],
        "false alarms as asked within 3 points": abs(alarms["found"] - alarms["asked"]) <= MOST_OFF,
    }
    if not {*METHODS} <= {*last}:
        return of_start
    return of_start | {
        "no method ends below its start": all(rate >= first for rate in last.values()),
        "SHEATH's last policy succeeds in .60": last["sheath"] >= LEAST_SUCCESS,
        "SHEATH's last policy above random takeover's": last["sheath"] > last["random-takeover"],
    }
