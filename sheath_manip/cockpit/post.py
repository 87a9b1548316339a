"""How a person drives a robot, as a value: what a robot's process is told when it starts."""

from dataclasses import dataclass

from sheath_manip.cockpit import Cockpit
from sheath_manip.cockpit.driver import OperatedDriver
from sheath_manip.cockpit.standing import Standing
from sheath_manip.gates.patient import FOR_PEOPLE, RequestConfig
from sheath_manip.rollout.request import Driver, TimedDriver
from sheath_manip.rollout.watch import Deadline
from sheath_manip.task import SCRIPTED, Task
from sheath_manip.types import TaskSpec
from sheath_manip.types.operator_input import Binding


@dataclass(frozen=True)
class Post:
    """A robot's task, and how a person drives it: one alone as each of several."""

    task: Task
    spec: TaskSpec
    guide: tuple[Binding, ...]
    """the keys by which a person drives"""
    planar: bool = False
    dead_man: bool = True
    fallback: str = SCRIPTED
    """the expert, or a fallback controller by its name, that acts where nobody comes"""
    fallback_shown: str = ""
    """the same in words"""
    hold: str | None = None
    """the controller that keeps the robot where it is; None: the simulation stands still"""
    wait_s: float = float("inf")
    """for the person, before the fallback acts"""
    requests: RequestConfig = FOR_PEOPLE
    speed: float = 1.0
    """times the task's own pace, and the page's slider"""
    deadline: Deadline | None = None

    def cockpit(self, standing: Standing | None = None) -> Cockpit:
        """Return the robot's own cockpit, which begins as others stand, if there are any."""
        return Cockpit(
            self.guide,
            paced=True,
            fallback=self.fallback_shown,
            planar=self.planar,
            standing=standing,
        )

    def driver(self, driver: Driver, cockpit: Cockpit) -> Driver:
        """Return `driver` with the person at `cockpit` beside it."""
        operated = OperatedDriver(
            driver,
            cockpit,
            fallback=self.fallback,
            hold=self.hold,
            wait_s=self.wait_s,
            dead_man=self.dead_man,
            requests=self.requests,
        )
        return operated if self.deadline is None else TimedDriver(operated, self.deadline)
