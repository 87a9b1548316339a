"""What is claimed of the gates in `results/takeovers`: only where README and documents say it."""

from functools import partial

from sheath_manip.experiments.claims import Claim, Summary, constant
from sheath_manip.experiments.takeovers.plan import BASELINES_OF, SHARE, TAKEOVERS

BETTER = (
    ("driving", TAKEOVERS, 1.0),
    ("driving", SHARE, 0.08),
    ("gauze-cutting", TAKEOVERS, 1.0),
    ("gauze-cutting", SHARE, 0.05),
    ("gauze-cutting", SHARE, 0.08),
    ("platformer", SHARE, 0.03),
    ("platformer", SHARE, 0.05),
    ("platformer", SHARE, 0.08),
)
"""task, what is held equal, and at which value the gate is better than all that looks at nothing"""
LEAST_SCENES = {"driving": 100, "platformer": 100}
"""in which the policies fail alone, by task"""


def fails_more(task: str, axis: str, value: float, summary: Summary) -> float:
    """Return how much more of the same scenes fails under the best of what looks at nothing.

    That is the lower end of the 95 % interval of the difference by scene: above 0 the gate is
    better.
    """
    ways = _target(task, axis, value, summary)["ways"]
    return min(ways[name]["fails_more_ci95"][0] for name in BASELINES_OF[axis])


def scenes(task: str, summary: Summary) -> float:
    """Return in how many scenes the policies fail alone."""
    return summary["tasks"][task]["targets"][0]["ways"]["gate"]["scenes"]


def _target(task: str, axis: str, value: float, summary: Summary) -> Summary:
    for target in summary["tasks"][task]["targets"]:
        if (target["axis"], target["value"]) == (axis, value):
            return target
    raise KeyError(f"{task} at {value:g} {axis}")


def _named(task: str, axis: str, value: float) -> str:
    held = f"{value:g} takeovers" if axis == TAKEOVERS else f"{100 * value:g} % share"
    return f"{task}, {held}: baselines fail more by, at least"


CLAIMS = (
    *(
        Claim(_named(*where), partial(fails_more, *where), ">", partial(constant, 0.0))
        for where in BETTER
    ),
    *(
        Claim(f"{task}: failing scenes", partial(scenes, task), ">=", partial(constant, least))
        for task, least in LEAST_SCENES.items()
    ),
)
