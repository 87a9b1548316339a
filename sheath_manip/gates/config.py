"""Everything that a gate is made from, as plain values: what a checkpoint keeps of it."""

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Self

from sheath_manip.exceptions import ParameterError
from sheath_manip.files.json_files import plain
from sheath_manip.gates.blocks import BlocksConfig
from sheath_manip.gates.labels import label_rules, require_label_rules
from sheath_manip.gates.labels.config import LabellingConfig
from sheath_manip.gates.patient import RequestConfig
from sheath_manip.signals import SignalChoice
from sheath_manip.support import support_hyperparameters
from sheath_manip.support.config import SupportConfig, ThresholdConfig

USED = (
    "kind",
    "expert_share",
    "release_margin",
    "quiet_steps",
    "minimum_hold_steps",
    "dose_every_steps",
    "requests",
    "labels",
    "labelling",
    "blocks",
)
"""settings that no fit and no calibration looks at"""


@dataclass(frozen=True)
class GateConfig:
    """The gate's settings: what it looks at, where it draws the line, and how a takeover ends."""

    kind: str = "support"
    """gate that decides who acts: support (SHEATH), query-filter (SHIV), expert, mixture (at
    random, DAgger's and SMILe's), random-takeover, random-blocks or human; only the first two judge
    by a signal"""
    expert_share: float = 0.0
    """expert's share of the steps in a mixture or a random takeover, 0 .. 1"""
    blocks: BlocksConfig = field(default_factory=BlocksConfig)
    signal: str = "joined"
    """signal that the gate looks at, as `sheath tasks` lists it: the support, the precedent of the
    proposed action, or both joined; for continuous actions the precedent is a near one"""
    embedding: str = "two-scale-contrasts"
    """embedding on which the support is estimated, as `sheath tasks` lists it"""
    precedent_embedding: str = "foveal-contrasts"
    """embedding in which precedents of the policy's action are looked for"""
    support: SupportConfig = field(default_factory=SupportConfig)
    threshold: ThresholdConfig = field(default_factory=ThresholdConfig)
    release_rate: float = 0.0
    """share of new expert steps below the score at which the expert hands back (LazyDAgger), where
    that is above the threshold"""
    release_margin: float = 0.0
    """distance, >= 0 in units of the score, by which a state must be above the score of release"""
    quiet_steps: int = 0
    """steps in a row above the score of release before the expert hands back"""
    minimum_hold_steps: int = 0
    """least number of steps for which the expert acts once it has taken over"""
    dose_every_steps: int = 0
    """steps from one of the expert's to its next while the gate alarms, the policy acting between
    them, which is for programs as experts; 0: the expert acts in all"""
    stuck_steps: int = 0
    """steps in which the robot does not get on, since it stands still or comes back to where it
    was, by the expert's own least; then the expert takes over; 0: nobody notices"""
    requests: RequestConfig = field(default_factory=RequestConfig)
    labels: str = "all"
    """states that the expert labels beside those in which it acts: all, own (no others), drawn (a
    share of them), before-failure (the last of an episode that failed), or several joined by +"""
    labelling: LabellingConfig = field(default_factory=LabellingConfig)

    def __post_init__(self) -> None:
        if not 0 <= self.expert_share <= 1:
            raise ParameterError(f"expert_share is {self.expert_share}; wanted 0 .. 1")
        if not 0 <= self.release_rate < 1:
            raise ParameterError(f"release_rate is {self.release_rate}; wanted 0 to below 1")
        for name in ("release_margin", "quiet_steps", "minimum_hold_steps", "stuck_steps"):
            if not getattr(self, name) >= 0:
                raise ParameterError(f"{name} is {getattr(self, name)}; wanted at least 0")
        if self.stuck_steps == 1:
            raise ParameterError(
                "stuck_steps is 1; wanted 0 or at least 2, the while in two halves"
            )
        if self.dose_every_steps:
            self._require_doses()
        require_label_rules(self.labels)

    def fitted_like(self, other: Self) -> bool:
        """Tell whether what one was fitted to serves the other: they differ in use alone."""
        used = {name: getattr(other, name) for name in USED}
        return dataclasses.replace(self, **used) == other

    def _require_doses(self) -> None:
        if self.dose_every_steps < 2:
            raise ParameterError(
                f"dose_every_steps is {self.dose_every_steps}; wanted 0 or at least 2, like 10"
            )
        longer = ("release_rate", "release_margin", "quiet_steps", "minimum_hold_steps")
        if self.requests.limits or any(getattr(self, name) for name in longer):
            raise ParameterError(
                f"dose_every_steps goes with no limits on requests and no {', '.join(longer)}, "
                "since a dose is one step; wanted one or the other"
            )

    @property
    def hindsight_s(self) -> float:
        """Time before a failure that the expert labels afterwards; 0 where no rule looks back."""
        looks_back = any(rule.looks_back for rule in label_rules(self.labels))
        return self.labelling.before_failure_s if looks_back else 0.0

    @property
    def support_has_nu(self) -> bool:
        """Whether its support estimator knows a nu."""
        return "nu" in support_hyperparameters(self.support)

    def described(self) -> dict[str, Any]:
        """Return plain values, nested, that JSON keeps; `from_described` takes them back."""
        return plain(dataclasses.asdict(self))

    @classmethod
    def from_described(cls, content: Mapping[str, Any]) -> Self:
        """Return the config that `described` gave; what is missing has its default.

        Raises ParameterError for a setting that there is none of, or a value outside its range.
        """
        try:
            settings = dict(content)
            support = SupportConfig(**settings.pop("support", {}))
            threshold = ThresholdConfig(**settings.pop("threshold", {}))
            requests = RequestConfig(**settings.pop("requests", {}))
            labelling = LabellingConfig(**settings.pop("labelling", {}))
            blocks = dict(settings.pop("blocks", {}))
            if "steps" in blocks:
                blocks["steps"] = tuple(blocks["steps"])
            return cls(
                **settings,
                support=support,
                threshold=threshold,
                requests=requests,
                labelling=labelling,
                blocks=BlocksConfig(**blocks),
            )
        except TypeError as error:
            raise ParameterError(f"{content} is no config of a gate: {error}") from error


def planned_signal(config: GateConfig) -> SignalChoice:
    """Return the choice that `config` names; raises UnknownNameError for its support."""
    return SignalChoice(
        signal=config.signal,
        embedding=config.embedding,
        support=config.support.name,
        precedent_embedding=config.precedent_embedding,
        hyperparameters=support_hyperparameters(config.support),
    )
