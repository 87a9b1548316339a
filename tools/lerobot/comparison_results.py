"""What the comparison says of all training seeds together, and which bars hold."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from sheath_manip.experiments.takeovers.figures_of_trials import interval
from sheath_manip.metrics import rate_interval
from tools.lerobot.bars import LEAST_SUCCESS
from tools.lerobot.comparison_plan import COMPARED, RANDOM, SHEATH, ComparisonPlan

START = "start"
Seeds = Mapping[int, Mapping[str, Any]]
"""by training seed, what `SeedRun.stages` yields"""


def through(seeds: Seeds, plan: ComparisonPlan) -> dict[int, Mapping[str, Any]]:
    """Return the training seeds of which every method has its last policy."""
    return {
        seed: found
        for seed, found in seeds.items()
        if all(len(found["methods"].get(name, ())) == plan.rounds for name in COMPARED)
    }


def together(seeds: Seeds) -> dict[str, Any]:
    """Return success, burden and difference to SHEATH of each method, over these seeds.

    Intervals of rates are Wilson's, those of differences the bootstrap's over scenes; episodes
    count as independent, and so few training runs say little about a next one.
    """
    wins = {
        name: np.concatenate([np.asarray(_last(found, name), float) for found in seeds.values()])
        for name in (START, *COMPARED)
    }
    return {
        name: {
            "episodes": len(won),
            "success_rate": float(won.mean()),
            "ci95": {"success_rate": rate_interval(int(won.sum()), len(won))},
            "success_by_seed": {
                str(seed): float(np.mean(_last(found, name))) for seed, found in seeds.items()
            },
            "less_than_sheath_ci95": interval(range(len(won)), wins[SHEATH] - won),
            **({} if name == START else {"learning": _while_learning(seeds, name)}),
        }
        for name, won in wins.items()
    }


def comparison_bars(found: Mapping[str, Any]) -> dict[str, bool]:
    """Return the bars of the rounds, and whether they hold, by what `together` returns."""
    rates = {name: each["success_rate"] for name, each in found.items()}
    return {
        "no method ends below its start": all(rate >= rates[START] for rate in rates.values()),
        "SHEATH's last policy succeeds in .60": rates[SHEATH] >= LEAST_SUCCESS,
        "SHEATH's last policy above random takeover's": rates[SHEATH] > rates[RANDOM],
    }


def _last(found: Mapping[str, Any], name: str) -> Sequence[bool]:
    stage = found["start"] if name == START else found["methods"][name][-1]
    return stage["alone"]["succeeds"]


def _while_learning(seeds: Seeds, name: str) -> dict[str, float]:
    """Success and burden in the rounds' episodes."""
    rounds = [each["learning"] for found in seeds.values() for each in found["methods"][name]]
    count = sum(each["episodes"] for each in rounds)
    steps = sum(each["steps"] for each in rounds)
    won = sum(each["success_rate"] * each["episodes"] for each in rounds)
    return {
        "episodes": count,
        "success_rate": won / count,
        "expert_share": sum(each["expert_share"] * each["steps"] for each in rounds) / steps,
        "takeovers_an_episode": sum(
            each["takeovers_an_episode"] * each["episodes"] for each in rounds
        )
        / count,
        "labels": sum(each["labels"] for each in rounds),
        "steps": steps,
    }
