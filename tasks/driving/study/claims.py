"""What is claimed of `results/driving`."""

from functools import partial
from itertools import accumulate

from sheath_manip.experiments.asked_claims import CLAIMS as ASKED
from sheath_manip.experiments.claims import Claim, Summary, constant, missing, uninformed
from sheath_manip.experiments.measures import (
    evaluation_scenes,
    executed_failures,
    executed_failures_at_random,
    experts_failures,
    rounds,
    training_seeds,
    wall_minutes_a_method,
)


def third_of_daggers(summary: Summary) -> float:
    """A third of DAgger's executed failure rate."""
    return executed_failures("dagger", summary) / 3


def expert_share(summary: Summary) -> float:
    """Return the expert's share of SHEATH's steps over all rounds."""
    return summary["methods"]["sheath"]["overall"]["expert_share"]


def rounds_above_random(summary: Summary) -> float:
    """Return in how many rounds SHEATH failed more often than takeovers at random."""
    ours, random = (_executed(summary, method) for method in ("sheath", uninformed(summary)))
    return sum(own > other for own, other in zip(ours, random, strict=False))


def rounds_not_below_random_so_far(summary: Summary) -> float:
    """Return after how many rounds SHEATH had failed as often as takeovers at random, or more.

    Counted from the first round on: where neither failed a round tells nothing of its own.
    """
    ours, random = (_executed(summary, method) for method in ("sheath", uninformed(summary)))
    pairs = zip(accumulate(ours), accumulate(random), strict=False)
    return sum(own >= other for own, other in pairs)


def _executed(summary: Summary, method: str) -> list[float]:
    """Failure rates of rounds 1 and up."""
    rounds = summary["methods"][method]["rounds"][1:]
    return [entry["executed"]["failure_rate"] for entry in rounds]


def laps_lost(summary: Summary) -> float:
    """Laps that SHEATH's last policy drives less than DAgger's, alone, of the final variant's."""
    dagger, own = (
        summary["methods"][method]["final"]["metric"]["laps"] for method in ("dagger", "sheath")
    )
    return dagger - own


def interval_width(summary: Summary) -> float:
    """Half the 95 % interval of the final laps of DAgger's last policy."""
    low, high = summary["methods"]["dagger"]["final"]["ci95"]["laps"]
    return (high - low) / 2


def false_alarm_error(summary: Summary) -> float:
    """Return how far SHEATH's mean false-alarm rate on fresh expert laps is from the asked one."""
    asked = summary["plan"]["gate"]["threshold"]["false_alarm_rate"]
    return abs(summary["methods"]["sheath"]["overall"]["false_alarm_rate"] - asked)


ALL = (
    Claim("training seeds", training_seeds, ">=", partial(constant, 3)),
    Claim("rounds", rounds, ">=", partial(constant, 8)),
    Claim("held-out traffic seeds", evaluation_scenes, ">=", partial(constant, 20)),
    # 90 minutes for the four methods that were compared at first.
    Claim("wall time a method, minutes", wall_minutes_a_method, "<=", partial(constant, 90 / 4)),
    Claim("expert's failure rate", experts_failures, "<=", partial(constant, 0.02)),
    Claim(
        "SHEATH's executed failure rate, a third of DAgger's",
        partial(executed_failures, "sheath"),
        "<=",
        third_of_daggers,
    ),
    Claim("SHEATH's expert share", expert_share, "<=", partial(constant, 0.3)),
    Claim(
        "rounds in which SHEATH failed more often than takeovers at random",
        rounds_above_random,
        "<=",
        partial(constant, 0),
    ),
    Claim(
        "rounds up to which SHEATH failed as often as takeovers at random",
        rounds_not_below_random_so_far,
        "<=",
        partial(constant, 0),
    ),
    Claim("final laps lost to DAgger, its interval", laps_lost, "<=", interval_width),
    Claim(
        "SHEATH's executed failure rate, that of takeovers at random",
        partial(executed_failures, "sheath"),
        "<",
        executed_failures_at_random,
    ),
    Claim("false alarms, off the asked rate", false_alarm_error, "<=", partial(constant, 0.03)),
    *ASKED,
)
CLAIMS = missing(
    ALL,
    # In episodes of 14 s one request each is 4.3 a minute.
    "requests a minute in the last round",
    "final laps lost to DAgger, its interval",
)
