"""The settings of one experiment: how much to learn and with what."""

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Self, TypeVar

from sheath_manip.exceptions import ParameterError, UnknownNameError
from sheath_manip.gates.config import GateConfig
from sheath_manip.policies.config import PolicyConfig

Config = TypeVar("Config")

LEAST_CALIBRATION = 3
"""held-out expert episodes that a threshold wants"""


@dataclass(frozen=True)
class Schedule:
    """A schedule of learning: what is demonstrated, and the rounds that follow."""

    demonstrations: int = 10
    """expert episodes before round 1"""
    demonstration_noise: float = 0.0
    """noise on the demonstrations' actions, as a share of half the actions' range (DART)"""
    calibration: int = 30
    """held-out expert episodes for the threshold, at least 3; steps of one resemble each other, so
    three will do but ten still miss the asked rate by five points, and twenty by three"""
    false_alarm_episodes: int = 20
    """further held-out expert episodes, to measure false alarms"""
    rounds: int = 8
    """number of rounds after the demonstrations"""
    episodes: int = 8
    """number of episodes per round"""
    stop_below_loss: float = 0.0
    """end the rounds once the surrogate loss of a round is below this"""
    beta: float = 0.5
    """decay of DAgger's mixture: in round i the expert acts with probability beta^i"""
    alpha: float = 0.1
    """SMILe's share of the newest policy in what was the expert's"""
    first_false_alarm_rate: float = 0.0
    """rate of false alarms, below 1, that the first round's gate keeps to where that is more than
    the threshold's own, to which it halves from round to round: a first policy fails most; 0: the
    same in all rounds"""
    variant: str = "default"
    """variant of the task to learn and be judged on; one of its `run_variants` is made for each
    run"""

    def __post_init__(self) -> None:
        _at_least_one(self, ("rounds", "episodes", "demonstrations", "false_alarm_episodes"))
        if self.calibration < LEAST_CALIBRATION:
            raise ParameterError(
                f"calibration is {self.calibration}; "
                f"the threshold wants at least {LEAST_CALIBRATION} held-out episodes"
            )
        if not 0 < self.alpha < 1:
            raise ParameterError(f"alpha is {self.alpha}; wanted 0 .. 1")
        if self.demonstration_noise < 0:
            raise ParameterError(
                f"demonstration_noise is {self.demonstration_noise}; wanted at least 0, like 0.1"
            )
        for name in ("beta", "first_false_alarm_rate"):
            if not 0 <= getattr(self, name) < 1:
                raise ParameterError(f"{name} is {getattr(self, name)}; wanted 0 to below 1")


@dataclass(frozen=True)
class Comparison:
    """A comparison: what is held against what, on which scenes."""

    methods: tuple[str, ...] = (
        "cloning",
        "dagger",
        "sheath",
        "sheath-own-labels",
        "random-blocks",
        "hg-dagger",
    )
    """names of the methods, as `sheath tasks` lists them"""
    seeds: tuple[int, ...] = (0, 1, 2)
    """seeds of the training runs"""
    evaluation_episodes: int = 20
    """scenes on which the policy alone is judged after each round"""
    final_episodes: int = 20
    """scenes of the final variant on which the last policy is judged"""
    final_variant: str = "final"
    """variant of the task on which the last policy is judged; of a task without a `final` the one
    that is learned on"""
    held_out_set: str = "held-out"
    """name of the set of evaluation scenes; tuning uses another"""

    def __post_init__(self) -> None:
        for name in ("methods", "seeds"):
            if not getattr(self, name):
                raise ParameterError(f"{name} is empty; wanted at least one")
        _at_least_one(self, ("evaluation_episodes", "final_episodes"))


@dataclass(frozen=True)
class LearningPlan:
    """The settings of rounds of learning; the same plan and seed give the same result."""

    policy: PolicyConfig = field(default_factory=PolicyConfig)
    gate: GateConfig = field(default_factory=GateConfig)
    schedule: Schedule = field(default_factory=Schedule)
    comparison: Comparison = field(default_factory=Comparison)

    def units(self) -> int:
        """Return how many episodes and fits the experiment runs, repeated preparation included."""
        comparison, of_method = self.comparison, self.units_of_run()
        return len(comparison.seeds) * (self._first + len(comparison.methods) * of_method)

    def units_of_run(self) -> int:
        """Return how many of them one method has from one training seed."""
        schedule, comparison = self.schedule, self.comparison
        rounds = schedule.rounds * (schedule.episodes + 1 + comparison.evaluation_episodes)
        return self._first + rounds + comparison.final_episodes

    @property
    def _first(self) -> int:
        """Return how many there are of round 0, which each method reads again."""
        schedule = self.schedule
        held_out = schedule.calibration + schedule.false_alarm_episodes
        return schedule.demonstrations + held_out + 1 + self.comparison.evaluation_episodes

    @property
    def rounds_are_known(self) -> bool:
        """Whether there are as many rounds as planned, whatever they show."""
        return self.schedule.stop_below_loss <= 0

    def for_round(self, number: int) -> Self:
        """Return the plan as it is in a round, from 1: in the first ones the gate may ask more."""
        first, threshold = self.schedule.first_false_alarm_rate, self.gate.threshold
        rate = max(first / 2 ** (number - 1), threshold.false_alarm_rate)
        if rate == threshold.false_alarm_rate:
            return self
        return self.changed(gate={"threshold": {"false_alarm_rate": rate}})

    def changed(self, **parts: Mapping[str, Any]) -> Self:
        """Return the plan with other values, such as `changed(schedule={"rounds": 2})`.

        A value that is a mapping changes a part of a part: `gate={"support": {"nu": 0.1}}`; the
        policy's settings are one value, and are exchanged as a whole.
        """
        return _changed(self, parts)

    def described(self) -> dict[str, Any]:
        """Return plain values, for summaries and for recognising a run that is resumed."""
        return dataclasses.asdict(self)


def _changed(config: Config, values: Mapping[str, Any]) -> Config:
    known = [each.name for each in dataclasses.fields(config)]  # pyright: ignore
    for name in values:
        if name not in known:
            raise UnknownNameError(f"setting of {type(config).__name__}", name, known)
    new = {
        name: _changed(held, value)
        if dataclasses.is_dataclass(held := getattr(config, name)) and isinstance(value, Mapping)
        else value
        for name, value in values.items()
    }
    return replace(config, **new)  # pyright: ignore[reportArgumentType,reportCallIssue]


def _at_least_one(config: Any, names: tuple[str, ...]) -> None:
    for name in names:
        if getattr(config, name) < 1:
            raise ParameterError(f"{name} is {getattr(config, name)}; wanted at least 1")
