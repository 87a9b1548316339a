"""What is claimed of `results/driving`."""

from functools import partial

from sheath_manip.claims import Claim, Summary, constant


def failure_rate(method: str, summary: Summary) -> float:
    """Executed failure rate over all rounds and seeds."""
    return summary["methods"][method]["overall"]["failure_rate"]


def half_of_daggers(summary: Summary) -> float:
    """Half of DAgger's executed failure rate."""
    return failure_rate("dagger", summary) / 2


def experts_failure_rate(summary: Summary) -> float:
    """Of all episodes that the expert drove alone."""
    return summary["expert"]["failure_rate"]


def false_alarm_error(summary: Summary) -> float:
    """How far SHEATH's mean false-alarm rate on fresh expert laps is from the asked one."""
    asked = summary["plan"]["false_alarm_rate"]
    return abs(summary["methods"]["sheath"]["overall"]["false_alarm_rate"] - asked)


def rounds(summary: Summary) -> float:
    """After the demonstrations."""
    return len(summary["methods"]["sheath"]["rounds"]) - 1


def training_seeds(summary: Summary) -> float:
    """Number of training seeds."""
    return len(summary["seeds"])


def held_out_scenes(summary: Summary) -> float:
    """Scenes on which the policy alone is judged after each round."""
    return summary["plan"]["held_out"]


def wall_minutes(summary: Summary) -> float:
    """Wall time of the experiment."""
    return summary["wall_s"] / 60


CLAIMS = (
    Claim("training seeds", training_seeds, ">=", partial(constant, 3)),
    Claim("rounds", rounds, ">=", partial(constant, 8)),
    Claim("held-out traffic seeds", held_out_scenes, ">=", partial(constant, 20)),
    Claim("wall time, minutes", wall_minutes, "<=", partial(constant, 90)),
    Claim("expert's failure rate", experts_failure_rate, "<=", partial(constant, 0.02)),
    Claim(
        "SHEATH's executed failure rate, half of DAgger's",
        partial(failure_rate, "sheath"),
        "<=",
        half_of_daggers,
    ),
    Claim(
        "SHEATH's executed failure rate, random takeover's",
        partial(failure_rate, "sheath"),
        "<",
        partial(failure_rate, "random-takeover"),
    ),
    Claim("false alarms, off the asked rate", false_alarm_error, "<=", partial(constant, 0.03)),
)
