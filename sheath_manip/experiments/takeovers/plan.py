"""How much the benchmark of takeovers measures."""

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Self

from sheath_manip.exceptions import ParameterError
from sheath_manip.experiments.study import Study
from sheath_manip.learning.config import LearningPlan

METHOD = "dagger"
"""by which the policies learn that gates watch over: its rounds want no gate"""
TUNING, FRESH = "tuning", "fresh"
"""lots of scenes: gates are chosen on the first, and judged once on the second"""
TAKEOVERS, SHARE = "takeovers", "share"
"""what is held equal: takeovers an episode, or the expert's share of the steps"""
BASELINES_OF = {
    TAKEOVERS: ("random-blocks", "own-at-random-times", "another-scenes"),
    SHARE: ("random-steps", "every-kth-step"),
}
"""what a gate is held against, by what is held equal"""


@dataclass(frozen=True)
class Quota:
    """How many scenes of a lot gates are tried on, and how many are looked through for them."""

    failing: int = 9
    """scenes of a lot in which the policy alone does not succeed"""
    succeeding: int = 2
    """scenes of a lot in which it does, to see what a gate breaks"""
    most: int = 100
    """scenes of a lot on which the policy is tried alone, at most"""

    def __post_init__(self) -> None:
        if self.failing < 1 or self.most < self.failing:
            raise ParameterError(
                f"failing is {self.failing} and most {self.most}; wanted 1 <= failing <= most"
            )

    def smaller(self, share: float) -> Self:
        """Return that share of each number, at least one."""
        numbers = (self.failing, self.succeeding, self.most)
        return type(self)(*(max(1, round(share * number)) for number in numbers))


@dataclass(frozen=True)
class Kind:
    """A gate without its threshold."""

    signal: str
    """by which it judges: `default` is the task's own, `precedent` its precedents alone, others by
    name"""
    turn_s: float
    """shortest turn of the expert; 0: a step"""
    notices_stuck: bool = False
    """whether it takes over as well where nothing goes on, by the rule of the task's own gate"""
    dose_every_s: float = 0.0
    """time from one step of the expert to the next while it alarms; 0: it acts in all"""

    @property
    def name(self) -> str:
        """In files."""
        doses = f"-doses-{self.dose_every_s:g}s" if self.dose_every_s else ""
        stuck = "-stuck" if self.notices_stuck else ""
        return f"{self.signal}-{self.turn_s:g}s{doses}{stuck}"


KINDS = tuple(
    Kind(signal, turn_s, notices_stuck)
    for signal in ("default", "precedent")
    # A share goes farthest in single steps, and a call in turns of two seconds.
    for turn_s, notices_stuck in ((0.0, False), (2.0, False), (2.0, True))
)
MOVING = tuple(kind for kind in KINDS if not kind.notices_stuck)
"""for tasks in which nothing stands still"""
DOSES = tuple(Kind(signal, 0.0, dose_every_s=0.5) for signal in ("default", "precedent"))
"""of single steps: nearest to what looks at nothing, which alarms in all states"""


@dataclass(frozen=True)
class GateChoice(Kind):
    """A gate."""

    level: float = 0.0
    """where its threshold lies, see `level_threshold`"""

    @classmethod
    def of(cls, kind: Kind, level: float) -> Self:
        """Return the gate of a kind with a threshold."""
        return cls(kind.signal, kind.turn_s, kind.notices_stuck, kind.dose_every_s, level)


@dataclass(frozen=True)
class TakeoversPlan:
    """The settings of the benchmark; the same plan and seeds give the same result."""

    tasks: tuple[str, ...] | None = None
    """whose gates are compared; all where None"""
    learning: str = "full"
    """the task's plan that says what is demonstrated, fitted, and what the default gate is"""
    seeds: tuple[int, ...] = (0, 1, 2)
    """of training runs"""
    rounds: tuple[int, ...] = (0, 1, 2, 4)
    """after which a policy is watched over: the fewer, the worse it is"""
    scenes: Quota = field(default_factory=Quota)
    """that each policy is tried on"""
    stretch_s: float | None = None
    """length of a scene; None: it is the whole episode"""
    tuning_share: float = 0.4
    """of those numbers, for the tuning lot"""
    kinds: tuple[Kind, ...] = (*KINDS, *DOSES)
    """gates that are tried"""
    levels: tuple[float, ...] = (-2.0, -1.0, -0.5, -0.2, 0.0, 0.005, 0.01, 0.02, 0.04, 0.08)
    """thresholds that are tried, see `level_threshold`"""
    dose_levels: tuple[float, ...] = (0.0, 0.02, 0.08, 0.2, 0.4, 0.7, 0.95)
    """and those of gates with doses, which may alarm in most states"""
    takeovers: tuple[float, ...] = (0.25, 0.5, 1.0, 2.0)
    """an episode that fails alone, at which gates and baselines are compared"""
    shares: tuple[float, ...] = (0.03, 0.05, 0.08, 0.13)
    """of the steps of such an episode, at which they are compared"""
    oracle: int = 3
    """failing scenes of each policy on which the oracle is tried"""
    oracle_turn_s: float = 0.5
    """length of its turns"""
    by_task: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    """fields that are others for a task, by its name"""

    def __post_init__(self) -> None:
        for name in ("seeds", "rounds", "kinds", "takeovers", "shares"):
            if not getattr(self, name):
                raise ParameterError(f"{name} is empty; wanted at least one")
        for name in ("levels", "dose_levels"):
            levels = getattr(self, name)
            if len(levels) < 2 or list(levels) != sorted(set(levels)) or levels[-1] >= 1:
                raise ParameterError(
                    f"{name} are {levels}; wanted two or more, rising, each below 1"
                )

    def for_task(self, name: str) -> Self:
        """Return the plan as it is for one task."""
        return dataclasses.replace(self, **self.by_task.get(name, {}), by_task={})

    @property
    def signals(self) -> tuple[str, ...]:
        """The signals that the kinds judge by."""
        return tuple(dict.fromkeys(kind.signal for kind in self.kinds))

    def levels_of(self, kind: Kind) -> tuple[float, ...]:
        """Return the thresholds at which gates of a kind are tried."""
        return self.dose_levels if kind.dose_every_s else self.levels

    def quota(self, lot: str) -> Quota:
        """Return how many scenes of a lot there are."""
        return self.scenes if lot == FRESH else self.scenes.smaller(self.tuning_share)

    def targets(self) -> list[tuple[str, float]]:
        """Return all (axis, value) at which gates are compared."""
        takeovers = [(TAKEOVERS, value) for value in self.takeovers]
        return takeovers + [(SHARE, value) for value in self.shares]

    def of(self, study: Study) -> LearningPlan:
        """Return what runs on the study's task, so that each policy of `rounds` is learned."""
        return study.plan(self.learning).changed(
            schedule={"rounds": max(1, *self.rounds), "stop_below_loss": 0.0},
            comparison={
                "methods": (METHOD,),
                "seeds": self.seeds,
                "evaluation_episodes": 1,
                "final_episodes": 1,
            },
        )

    def described(self) -> dict[str, Any]:
        """Return the plan as plain values, for summaries."""
        return dataclasses.asdict(self)

    def settings(self) -> dict[str, Any]:
        """Return what a resumed run must have in common: all but the choice of tasks.

        Gates are chosen by the policies of all seeds together.
        """
        return {name: value for name, value in self.described().items() if name != "tasks"}


PLANS = {
    "full": TakeoversPlan(
        by_task={
            # Its policies fail seldom.
            "driving": {
                "scenes": Quota(failing=14, most=240),
                # And never stand still.
                "kinds": (*MOVING, *DOSES),
            },
            # A step of its simulated sheet takes as long as a hundred of driving's.
            "gauze-cutting": {
                "rounds": (0, 1),
                "scenes": Quota(failing=8, succeeding=1, most=60),
                "kinds": MOVING,
                "levels": (-1.0, -0.2, 0.0, 0.02, 0.08),
                "takeovers": (1.0,),
                "shares": (0.05, 0.08),
                "oracle": 1,
            },
            # Its policies fail several times in every episode.
            "platformer": {"learning": "across", "stretch_s": 6.0},
        }
    ),
    "quick": TakeoversPlan(
        tasks=("driving",),
        learning="quick",
        seeds=(0,),
        rounds=(0,),
        scenes=Quota(failing=3, succeeding=1, most=8),
        kinds=(Kind("default", 0.5),),
        levels=(-0.5, 0.0, 0.1),
        takeovers=(1.0,),
        shares=(0.08,),
        oracle=1,
    ),
}
