"""Which policy, and with which hyperparameters."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from sheath_manip.exceptions import ParameterError


@dataclass(frozen=True)
class PolicyConfig:
    """A choice for `make_policy`: a name in POLICIES and the values that it is called with."""

    name: str = "cnn"
    """policy to fit, as `sheath tasks` lists it"""
    settings: Mapping[str, Any] = field(default_factory=dict)
    """hyperparameters of the policy, by name"""

    def __post_init__(self) -> None:
        if not isinstance(self.settings, Mapping):
            raise ParameterError(
                f"settings is {self.settings!r}; wanted hyperparameters by name, "
                'like {"steps": 100}'
            )
