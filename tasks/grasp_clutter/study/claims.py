"""What is claimed of `results/grasp-clutter`."""

from functools import partial

from sheath_manip.experiments.claims import Claim, Summary, constant


def toppled_while_learning(method: str, summary: Summary) -> float:
    """Share of the executed episodes that toppled something, over all rounds and seeds."""
    return summary["methods"][method]["overall"]["failure_rate"]


def last_expert_share(summary: Summary) -> float:
    """Return the expert's share of SHEATH's steps in the last round."""
    return summary["methods"]["sheath"]["rounds"][-1]["expert_share"]


def success_alone(method: str, summary: Summary) -> float:
    """Return the success of the method's last policies alone, on the final held-out scenes."""
    return summary["methods"][method]["final"]["success_rate"]


def success_gained(method: str, summary: Summary) -> float:
    """Return what the last policies alone succeed more often than the first, on the same scenes."""
    rounds = summary["methods"][method]["rounds"]
    first, last = (entry["policy"]["success_rate"] for entry in (rounds[0], rounds[-1]))
    return last - first


def demonstrations(summary: Summary) -> float:
    """Clean ones, that all methods start from."""
    plan = summary["plan"]["schedule"]
    return plan["demonstrations"] if plan["demonstration_noise"] == 0 else float("nan")


def rounds(summary: Summary) -> float:
    """Return the number of rounds after the demonstrations."""
    return summary["methods"]["sheath"]["rounds"][-1]["round"]


def training_seeds(summary: Summary) -> float:
    """Number of training seeds."""
    return len(summary["seeds"])


def final_scenes(summary: Summary) -> float:
    """Held-out scenes on which each of the last policies is judged."""
    return summary["plan"]["comparison"]["final_episodes"]


def wall_minutes(summary: Summary) -> float:
    """Wall time of the experiment."""
    return summary["wall_s"] / 60


CLAIMS = (
    Claim("training seeds", training_seeds, ">=", partial(constant, 3)),
    Claim("clean demonstrations", demonstrations, "<=", partial(constant, 60)),
    Claim("rounds", rounds, ">=", partial(constant, 5)),
    Claim("held-out scenes of each final policy", final_scenes, ">=", partial(constant, 100)),
    Claim("wall time, minutes", wall_minutes, "<=", partial(constant, 100)),
    Claim(
        "share of SHEATH's executed episodes that topple something",
        partial(toppled_while_learning, "sheath"),
        "<=",
        partial(constant, 0.03),
    ),
    Claim(
        "SHEATH's expert share in the last round", last_expert_share, "<=", partial(constant, 0.35)
    ),
    Claim(
        "success of SHEATH's final policy alone",
        partial(success_alone, "sheath"),
        ">=",
        partial(constant, 0.85),
    ),
    Claim(
        "success that DAgger's policy alone gains over cloning",
        partial(success_gained, "dagger"),
        ">",
        partial(constant, 0),
    ),
)


def near_the_experts(summary: Summary) -> float:
    """Return one and a half times the expert's own failure rate, and 2 points."""
    return 1.5 * summary["expert"]["failure_rate"] + 0.02


HARD = (
    Claim("training seeds", training_seeds, ">=", partial(constant, 3)),
    Claim("clean demonstrations", demonstrations, "<=", partial(constant, 60)),
    Claim("held-out scenes of each final policy", final_scenes, ">=", partial(constant, 100)),
    Claim(
        "share of SHEATH's executed episodes that topple, 1.5 times the expert's and 2 points",
        partial(toppled_while_learning, "sheath"),
        "<=",
        near_the_experts,
    ),
)
"""of `results/grasp-clutter-hard`"""
RECIPE = (
    Claim("held-out scenes", final_scenes, ">=", partial(constant, 100)),
    Claim(
        "success of the recipe's policy alone",
        partial(success_alone, "cloning"),
        ">=",
        partial(constant, 0.93),
    ),
)
"""of `results/grasp-clutter-recipe`"""
