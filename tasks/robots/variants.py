"""A task's variants with any arm: those of its own, and `easy@ur5e` or `easy@my_arm.toml`."""

import logging
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache, partial
from typing import Any

from sheath_manip.protocols import Environment
from sheath_manip.tasks.robots.arm_file import SUFFIX, house_arms
from sheath_manip.tasks.robots.motions import said
from sheath_manip.tasks.robots.robot import RobotDescription

logger = logging.getLogger(__name__)

_WITH = "@"
_DEFAULT = "default"


@dataclass(frozen=True)
class ArmVariants(Mapping[str, Callable[[], Environment]]):
    """The scenarios of a task by name, each with the arm that it names or with another one.

    `ur5e` alone is `default@ur5e`. An arm's file is read when its environment is made, so that one
    whose package is not here costs nothing but a line.
    """

    make: Callable[[Any], Environment]
    """from a scenario, which has a field `robot`"""
    scenarios: Mapping[str, Any]
    arms: Mapping[str, RobotDescription]
    """that are no files, by name"""
    arm: Callable[[str], RobotDescription]
    """with the task's tool, from a name or a file"""

    def __getitem__(self, name: str) -> Callable[[], Environment]:
        if name in self.scenarios:
            return partial(self.make, self.scenarios[name])
        scenario, _, arm = name.rpartition(_WITH)
        scenario = scenario or _DEFAULT
        if scenario not in self.scenarios or not (arm in self._arms() or arm.endswith(SUFFIX)):
            raise KeyError(name)
        return partial(self._made, scenario, arm)

    def __iter__(self) -> Iterator[str]:
        yield from self.scenarios
        yield from self._arms()

    def __len__(self) -> int:
        return len(self.scenarios) + len(self._arms())

    def _arms(self) -> tuple[str, ...]:
        return (*self.arms, *house_arms())

    def _made(self, scenario: str, arm: str) -> Environment:
        robot = self.arms[arm] if arm in self.arms else self.arm(arm)
        if remark := said(robot):
            _say(f"{arm}: {remark}")
        return self.make(replace(self.scenarios[scenario], robot=robot))


@cache
def _say(line: str) -> None:
    """Once is enough: a run makes its environment more than once."""
    logger.warning("%s", line)
