"""How much to learn and with what: the settings of one experiment."""

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from sheath_manip.exceptions import ParameterError


@dataclass(frozen=True)
class LearningPlan:
    """The settings of rounds of learning; the same plan and seed give the same result."""

    policy: str = "cnn"
    policy_settings: Mapping[str, Any] = field(default_factory=dict)
    """hyperparameters of the policy, by name"""
    signal: str = "joined"
    """what the gate looks at: the support, the precedent of the proposed action, or both joined;
    for continuous actions the precedent is a near one"""
    embedding: str = "convolutions-and-pixels"
    """on which the support is estimated"""
    support: str = "one-class-svm"
    precedent_embedding: str = "foveal-convolutions"
    """in which precedents are looked for"""
    nu: float = 0.05
    """bound on the share of training states outside the support"""
    bandwidth_factor: float = 1.0
    """c of the RBF, in the unit below"""
    bandwidth_unit: str = "median"
    """`median`: the median squared distance of the training states; `dimensions`: the number of
    features, so that 0.01 are one binary feature in a hundred"""
    threshold_rule: str = "steps"
    """`steps`: a rate of false alarms in new expert steps; `episodes`: the probability of any in a
    new expert episode; `budget`: the expert's share of what the policy met last; `boundary`: the
    support's own, 0"""
    false_alarm_rate: float = 0.15
    """that the first two rules are calibrated for"""
    expert_budget: float = 0.15
    """that the third rule is calibrated for"""
    recalibrate: bool = True
    """every round, or only in the first (CRSAIL)"""
    release_rate: float = 0.0
    """share of new expert steps below the score at which the expert hands back (LazyDAgger), where
    that is above the threshold"""
    release_margin: float = 0.0
    """the gate's, as of `SupportGate`, added to that; the next two likewise"""
    quiet_steps: int = 0
    minimum_hold_steps: int = 0
    beta: float = 0.5
    """with which DAgger's mixture decays: in round i the expert acts with probability beta^i"""
    alpha: float = 0.1
    """SMILe's share of the newest policy in what was the expert's"""
    refit_unused: bool = True
    """fit the signal anew each round also for methods whose gate looks at none; else theirs stays
    that of the demonstrations, and only xi and the false alarms, which are measured with it, notice
    (of the platformer's CPU time it takes the largest part); through an embedding that the refitted
    policy changes, those of such a method mean nothing"""
    methods: tuple[str, ...] = ("cloning", "dagger", "sheath", "random-takeover")
    seeds: tuple[int, ...] = (0, 1, 2)
    """of training runs"""
    variant: str = "default"
    """of the task, to learn and be judged on; one of its `run_variants` is made for each run"""
    final_variant: str = "final"
    """of the task, on which the last policy is judged"""
    demonstrations: int = 10
    """expert episodes before round 1"""
    demonstration_noise: float = 0.0
    """with which their actions are disturbed, as a share of half the actions' range (DART)"""
    calibration: int = 30
    """held-out expert episodes for the threshold; steps of one resemble each other, so three will
    do but ten still miss the asked rate by five points, and twenty by three"""
    check: int = 20
    """further held-out expert episodes, to measure false alarms"""
    rounds: int = 8
    episodes: int = 8
    """in a round"""
    held_out: int = 20
    """scenes on which the policy alone is judged after each round"""
    final: int = 20
    """scenes of the final variant on which the last policy is judged"""
    held_out_set: str = "held-out"
    """which evaluation scenes; tuning uses another name"""
    stop_below_loss: float = 0.0
    """end the rounds once the surrogate loss of a round is below this"""

    def __post_init__(self) -> None:
        counts = ("rounds", "episodes", "demonstrations", "held_out", "final", "check")
        for name in counts:
            if getattr(self, name) < 1:
                raise ParameterError(f"{name} is {getattr(self, name)}; wanted at least 1")
        if self.calibration < 3:
            raise ParameterError(
                f"calibration is {self.calibration}; "
                "the threshold wants at least 3 held-out episodes"
            )
        if not 0 < self.nu <= 1:
            raise ParameterError(f"nu is {self.nu}; wanted more than 0 and at most 1")
        for name in ("false_alarm_rate", "expert_budget", "alpha"):
            if not 0 < getattr(self, name) < 1:
                raise ParameterError(f"{name} is {getattr(self, name)}; wanted 0 .. 1")
        if self.demonstration_noise < 0:
            raise ParameterError(
                f"demonstration_noise is {self.demonstration_noise}; wanted at least 0, like 0.1"
            )
        for name in ("release_rate", "beta"):
            if not 0 <= getattr(self, name) < 1:
                raise ParameterError(f"{name} is {getattr(self, name)}; wanted 0 to below 1")

    def units(self) -> int:
        """How many episodes and fits the whole experiment runs (repeated preparation included)."""
        first = self.demonstrations + self.calibration + self.check + 1 + self.held_out
        prepare = first - self.held_out
        rounds = self.rounds * (self.episodes + 1 + self.held_out) + self.final
        return len(self.seeds) * (first + len(self.methods) * (prepare + rounds))

    def described(self) -> dict:
        """As plain values, for summaries and for recognising a run that is resumed."""
        return dataclasses.asdict(self)
