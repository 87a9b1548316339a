"""What is claimed of driving's gates in `results/gates`."""

from collections.abc import Mapping
from functools import partial
from typing import Any

from sheath_manip.experiments.claims import Claim, Summary, constant

OFF_THE_ROAD = ("lateral 5 m", "lateral 7 m", "heading 45°", "heading 90°")
"""where nobody can be in doubt"""


def default(summary: Summary) -> Mapping[str, Any]:
    """The default gate's row."""
    found = summary["tasks"]["driving"]
    return found["rows"][found["default"]]


def support(summary: Summary) -> Mapping[str, Any]:
    """The row of the default embedding and estimator: the signal that ought to know the places."""
    found = summary["tasks"]["driving"]
    gate = found["learning"]["gate"]
    return found["rows"][f"{gate['embedding']}/{gate['support']['name']}"]


def auroc(displacement: str, summary: Summary) -> float:
    """Return the AUROC of new expert states against the displaced ones."""
    return support(summary)["auroc"][displacement]


def lowest_auroc(summary: Summary) -> float:
    """Return the lowest AUROC of the displacements off the road."""
    return min(auroc(name, summary) for name in OFF_THE_ROAD)


def expert_inside(summary: Summary) -> float:
    """Share of a new expert lap inside, at a threshold from few laps."""
    return support(summary)["few"]["expert_inside"]


def least_outside(summary: Summary) -> float:
    """Return, of the displacements off the road, the lowest share outside at that threshold."""
    return min(support(summary)["few"]["far_outside"][name] for name in OFF_THE_ROAD)


def costly(summary: Summary) -> float:
    """AUROC of 'the policy makes a costly mistake here'."""
    return default(summary)["errs"]["costly"]


def costly_of_single_signals(summary: Summary) -> float:
    """The best of the other gates that look at one signal only."""
    found = summary["tasks"]["driving"]
    return max(
        row["errs"]["costly"]
        for name, row in found["rows"].items()
        if len(row["signals"]) == 1 and name != found["default"]
    )


def foreseen(summary: Summary) -> float:
    """Share of the failures with an alarm before, at the plan's rate of disturbed windows."""
    return default(summary)["alarm"]["foreseen"]


def setting(name: str, summary: Summary) -> float:
    """Return a setting of the benchmark."""
    return summary["plan"][name]


def learning(name: str, summary: Summary) -> float:
    """Return a setting of what was demonstrated."""
    return summary["tasks"]["driving"]["learning"]["schedule"][name]


CLAIMS = (
    Claim("demonstrated laps", partial(learning, "demonstrations"), ">=", partial(constant, 10)),
    Claim(
        "new expert laps", partial(learning, "false_alarm_episodes"), ">=", partial(constant, 10)
    ),
    Claim(
        "laps that calibrate the few-lap threshold",
        partial(setting, "few"),
        "<=",
        partial(constant, 3),
    ),
    Claim("new expert states inside, few laps", expert_inside, ">=", partial(constant, 0.90)),
    Claim("AUROC at lateral 3.5 m", partial(auroc, "lateral 3.5 m"), ">=", partial(constant, 0.97)),
    Claim("lowest AUROC off the road or turned", lowest_auroc, ">=", partial(constant, 0.99)),
    Claim("AUROC of a car in front", partial(auroc, "car in front"), ">=", partial(constant, 0.85)),
    Claim(
        "lowest share outside, off the road or turned, few laps",
        least_outside,
        ">=",
        partial(constant, 0.95),
    ),
    Claim("AUROC of costly mistakes", costly, ">=", partial(constant, 0.75)),
    Claim("AUROC of costly mistakes, best single signal's", costly, ">", costly_of_single_signals),
    Claim(
        "failure-free windows disturbed",
        partial(setting, "alarm_rate"),
        "<=",
        partial(constant, 0.20),
    ),
    Claim("failures foreseen at that rate", foreseen, ">=", partial(constant, 0.90)),
)
