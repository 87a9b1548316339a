"""How much the benchmark of gates measures."""

import dataclasses
from dataclasses import dataclass
from typing import Any

from sheath_manip.exceptions import ParameterError, UnknownNameError
from sheath_manip.policies import EMBEDDINGS
from sheath_manip.support import SUPPORTS


@dataclass(frozen=True)
class GatesPlan:
    """The settings of the benchmark; the same plan and seed give the same result."""

    tasks: tuple[str, ...] | None = None
    """whose gates are compared; all that have probes where None"""
    learning: str = "full"
    """the task's plan that says what is demonstrated, what is fitted, and what the default gate is
    (its `check` episodes are the new expert episodes)"""
    seeds: tuple[int, ...] = (0, 1, 2)
    """of training runs"""
    loop_seeds: int = 1
    """of these the first so many, whose gates also take part in the loop, which takes longest"""
    embeddings: tuple[str, ...] | None = None
    """beside the default; all of the table where None"""
    supports: tuple[str, ...] | None = None
    """beside the default; all of the table where None, as with embeddings"""
    displaced_every: int = 6
    """steps of a new expert episode, between the states that are displaced"""
    displaced_episodes: int = 12
    """new expert episodes whose states are displaced, at most"""
    visited: int = 100
    """held-out scenes on which the policy drives alone and its mistakes are looked for"""
    window: int = 10
    """steps before a failure in which an alarm counts; also the length of failure-free windows"""
    spared: int = 20
    """last steps of a failed episode, which are no failure-free window"""
    alarm_rate: float = 0.20
    """of failure-free windows (or episodes) at which the alarms before failures are compared"""
    few: int = 3
    """calibration episodes of a threshold from few of them"""
    few_false_alarm_rate: float = 0.05
    """which that threshold is calibrated for"""
    rates: tuple[float, ...] = (0.05, 0.15, 0.30)
    """false-alarm rates whose thresholds are tried in the loop"""
    share: float = 0.15
    """of the steps in which the expert acts, at which gates are compared in the loop"""
    episodes: int = 12
    """in the loop, for each threshold of a main row"""
    held_out: int = 20
    """scenes on which the policy that learned under a main row's gate is judged"""
    other_episodes: int = 4
    """episodes for the rest of the grid, which with 0 takes no part in the loop"""
    other_held_out: int = 0
    """held-out scenes for the rest of the grid; with 0 no policy learns there"""

    def in_loop(self, main: bool) -> bool:
        """Return whether a row takes part in the loop, by whether it is a main one."""
        return main or self.other_episodes > 0

    def __post_init__(self) -> None:
        if not self.rates or not all(0 < rate < 1 for rate in self.rates):
            raise ParameterError(f"rates are {self.rates}; wanted some, each between 0 and 1")
        if not self.seeds:
            raise ParameterError("seeds is empty; wanted at least one")
        if self.loop_seeds < 1:
            raise ParameterError(f"loop_seeds is {self.loop_seeds}; wanted at least 1")
        for kind, names, known in (
            ("embedding", self.embeddings, EMBEDDINGS),
            ("support estimator", self.supports, SUPPORTS),
        ):
            for name in names or ():
                if name not in known:
                    raise UnknownNameError(kind, name, known)

    def described(self) -> dict[str, Any]:
        """Return the plan as plain values, for summaries."""
        return dataclasses.asdict(self)

    def settings(self) -> dict[str, Any]:
        """Return what a resumed run must have in common: all but the choice of rows and seeds."""
        rows = ("tasks", "embeddings", "supports", "seeds")
        return {name: value for name, value in self.described().items() if name not in rows}


PLANS = {
    "full": GatesPlan(tasks=("driving",)),
    # An episode of the arm costs ten times one of the car.
    "manipulation": GatesPlan(
        tasks=("grasp-clutter", "gauze-cutting"), seeds=(0,), other_episodes=0
    ),
    "quick": GatesPlan(
        learning="quick",
        seeds=(0,),
        embeddings=("penultimate",),
        supports=("mahalanobis",),
        displaced_every=12,
        displaced_episodes=3,
        visited=6,
        rates=(0.15,),
        episodes=2,
        held_out=1,
        other_episodes=1,
        other_held_out=0,
    ),
}
