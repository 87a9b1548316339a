"""Settings: which support estimator, and what its threshold keeps to."""

from dataclasses import dataclass

from sheath_manip.exceptions import ParameterError, UnknownNameError

RULES = ("steps", "episodes", "level", "boundary", "budget")


@dataclass(frozen=True)
class SupportConfig:
    """A choice of what `make_support` makes: a name in SUPPORTS and what is set of it."""

    name: str = "one-class-svm"
    """support estimator, as `sheath tasks` lists it"""
    nu: float = 0.05
    """bound, 0 .. 1, on the share of training states outside the support"""
    bandwidth_factor: float = 1.0
    """c of the RBF exp(-|x-y|²/c), in units of the bandwidth unit"""
    bandwidth_unit: str = "median"
    """unit of the bandwidth: median (of the squared distances between training states) or
    dimensions (the number of features, so that 0.01 are one binary feature in a hundred)"""

    def __post_init__(self) -> None:
        if not 0 < self.nu <= 1:
            raise ParameterError(f"nu is {self.nu}; wanted more than 0 and at most 1")
        if not self.bandwidth_factor > 0:
            raise ParameterError(
                f"bandwidth_factor is {self.bandwidth_factor}; wanted more than 0, like 1.0"
            )


@dataclass(frozen=True)
class ThresholdConfig:
    """A rule by which the score is found below which the expert takes over."""

    rule: str = "steps"
    """rule that sets the threshold: steps (a rate of false alarms in new expert steps), episodes
    (the probability of any in a new expert episode), level (a share of the expert's steps, or
    farther off than any of them), budget (the expert's share of what the policy met last) or
    boundary (the support's own, 0)"""
    false_alarm_rate: float = 0.15
    """rate of false alarms, 0 .. 1, that the rules steps and episodes keep to"""
    level: float = 0.0
    """share of held-out expert steps, below 1, that scores lower, for the rule level; below 0 the
    threshold lies so many times farther below the lowest score as that is below the median"""
    expert_budget: float = 0.15
    """share of the steps, 0 .. 1, that the rule budget gives to the expert"""
    recalibrate: bool = True
    """whether the threshold is found again every round, or the first round's stays (CRSAIL)"""

    def __post_init__(self) -> None:
        if self.rule not in RULES:
            raise UnknownNameError("threshold rule", self.rule, RULES)
        for name in ("false_alarm_rate", "expert_budget"):
            if not 0 < getattr(self, name) < 1:
                raise ParameterError(f"{name} is {getattr(self, name)}; wanted 0 .. 1")
        if not self.level < 1:
            raise ParameterError(f"level is {self.level}; wanted less than 1, like -0.5 or 0.01")
