"""How many labels the rules ask for."""

from dataclasses import dataclass

from sheath_manip.exceptions import ParameterError


@dataclass(frozen=True)
class LabellingConfig:
    """How many labels are asked for beside those of the expert's own steps."""

    an_episode: int = 0
    """labels that are asked for while the policy drives, in an episode at most, so that one that is
    stuck does not fill the data; 0: no limit"""
    drawn_share: float = 0.1
    """share, 0 .. 1, of the policy's steps that the rule `drawn` asks about"""
    before_failure_s: float = 0.5
    """time before a failure that the rule `before-failure` labels; it comes on top of the limit"""

    def __post_init__(self) -> None:
        if self.an_episode < 0:
            raise ParameterError(f"an_episode is {self.an_episode}; wanted at least 0")
        if not 0 <= self.drawn_share <= 1:
            raise ParameterError(f"drawn_share is {self.drawn_share}; wanted 0 .. 1, like 0.1")
        if not self.before_failure_s >= 0:
            raise ParameterError(
                f"before_failure_s is {self.before_failure_s}; wanted at least 0, like 0.5"
            )
