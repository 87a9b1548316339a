"""Options and parts of a run whose expert is a person at the page."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, fields, replace
from functools import partial
from typing import TYPE_CHECKING, Annotated, Any

from sheath_manip.cli.options import Address, default_is
from sheath_manip.cli.session import Session
from sheath_manip.cockpit import Cockpit, OperatedEnvironment
from sheath_manip.cockpit.gate import WAIT_S
from sheath_manip.exceptions import ParameterError
from sheath_manip.gates.patient import FOR_PEOPLE, RequestConfig
from sheath_manip.playback.labels import FALLBACK
from sheath_manip.protocols import Environment, Expert, Listener
from sheath_manip.rollout.pacing import Pacing
from sheath_manip.rollout.request import Driver, TimedDriver
from sheath_manip.rollout.watch import Deadline
from sheath_manip.task import HOLD, SCRIPTED, Task
from sheath_manip.types import TaskSpec

if TYPE_CHECKING:
    from sheath_manip.dashboard import Dashboard
    from sheath_manip.dashboard.explainer import Explainer
    from sheath_manip.dashboard.widget import WidgetFactory
    from sheath_manip.rollout.simulated_operator import OperatorConfig

PERSON = "person"
"""Name of a person among a task's experts."""
SIMULATED = "simulated-person"
"""Name of a simulated one, who sits where the person does."""


@dataclass(frozen=True)
class Operating:
    """Options on how a person operates; only with a person as the expert."""

    fallback: str = SCRIPTED
    """controller that acts if no operator takes over within --wait-s: the scripted expert, or a
    fallback that the task has, such as hold or back-up"""
    wait_s: float = WAIT_S
    """seconds to wait for the person before the fallback acts"""
    speed: float = 1.0
    """speed of the run: 1 is the task's control rate; the page's slider multiplies it"""
    spacemouse: bool = False
    """read the SpaceMouse that is plugged in here"""
    deadline: Annotated[float | None, default_is("1 with a person, else none")] = None
    """share of the control period after which policy and gate are late, so that the expert acts;
    then a call that hangs is broken off, too; 0 is none"""
    requests: RequestConfig = FOR_PEOPLE
    """how seldom a person is asked, where the checkpoint's own gate does not say; alarms count
    whatever is spared: who is asked too often drives on"""

    def timed(self, driver: Driver, paced: bool = True) -> Driver:
        """Return `driver` with its deadline: none where a run is not `paced`, unless asked for."""
        share = float(paced) if self.deadline is None else self.deadline
        return driver if share == 0 else TimedDriver(driver, Deadline(share / self.speed))

    def require_default(self, but: tuple[str, ...] = ("deadline",)) -> None:
        """Raise ParameterError where one is given that only a person could use, `but` those."""
        for each in fields(self):
            if each.name in but:
                continue
            value = getattr(self, each.name)
            if value != each.default:
                name = each.name.replace("_", "-")
                shown = "" if isinstance(value, RequestConfig) else f" {value}"
                raise ParameterError(f"--{name}{shown} is for a person; wanted --expert {PERSON}")

    def answered(self, driver: Driver, operator: "OperatorConfig") -> Driver:
        """Return `driver` with a simulated person beside it; ParameterError for his page's options.

        There is no page, and nobody is late where nothing waits for the clock.
        """
        from sheath_manip.cockpit.answered import AnsweredDriver

        self.require_default(but=("fallback", "wait_s", "deadline", "requests"))
        answered = AnsweredDriver(driver, operator, self.fallback, self.wait_s, self.requests)
        return self.timed(answered, paced=False)

    @contextmanager
    def crew(
        self,
        task: Task,
        address: Address,
        session: Session,
        gate: "tuple[WidgetFactory, ...]" = (),
        explainer: "Explainer | None" = None,
    ) -> Iterator["Crew"]:
        """The page with its controls, and the parts of a run that go with it.

        `gate` are the sliders of an adjustable gate, `explainer` says why it asks.
        """
        if task.teleop is None:
            raise ParameterError(f"nobody can drive {task.name} by hand; wanted a task with teleop")
        if not self.wait_s >= 0:
            raise ParameterError(f"wait_s is {self.wait_s}; wanted at least 0, such as {WAIT_S:g}")
        probe = task.make()
        spec, hands = probe.spec, task.teleop(probe)
        task.make_expert(probe, self.fallback)
        probe.close()
        stated = "scripted expert" if self.fallback == SCRIPTED else f"{FALLBACK} “{self.fallback}”"
        cockpit = Cockpit(hands.guide, paced=True, fallback=stated, planar=hands.planar)
        pacing = Pacing(self.speed, lambda: cockpit.speed)
        with ExitStack() as stack:
            if self.spacemouse:
                # Only now: it is an extra.
                from sheath_manip.cockpit.spacemouse import SpaceMouse

                stack.enter_context(SpaceMouse(cockpit))
            page = stack.enter_context(address.dashboard(spec, session, cockpit, gate, explainer))
            yield Crew(task, self, spec, cockpit, hands.dead_man, (page, pacing))


@dataclass(frozen=True, eq=False)
class Crew:
    """Who may act in a run that a person operates."""

    task: Task
    operating: Operating
    spec: TaskSpec
    cockpit: Cockpit
    dead_man: bool
    listeners: Sequence[Listener]
    """the page, then the pacing"""

    @property
    def page(self) -> "Dashboard":
        """The page."""
        return self.listeners[0]  # pyright: ignore[reportReturnType]

    def operated(self) -> Task:
        """The task, with episodes that a person may end; experts know the environment inside."""
        task = self.task
        return replace(
            task,
            expert=partial(_made_inside, task.expert),
            fallbacks={name: partial(_made_inside, make) for name, make in task.fallbacks.items()},
            variants=_Operated(task.variants, self._made),
            run_variants={
                name: partial(self._made, make) for name, make in task.run_variants.items()
            },
        )

    def _made(self, make: Callable[..., Environment], *seed: int) -> OperatedEnvironment:
        return OperatedEnvironment(make(*seed), self.cockpit)

    def driver(self, driver: Driver) -> Driver:
        """Return `driver` with the person beside it, and with a deadline."""
        from sheath_manip.cockpit.driver import OperatedDriver

        return self.operating.timed(
            OperatedDriver(
                driver,
                self.cockpit,
                fallback=self.operating.fallback,
                hold=HOLD if self.can_hold else None,
                wait_s=self.operating.wait_s,
                dead_man=self.dead_man,
                requests=self.operating.requests,
            )
        )

    @property
    def can_hold(self) -> bool:
        """Whether the robot can stay where it is."""
        return HOLD in self.task.fallbacks


@dataclass(frozen=True, eq=False)
class _Operated(Mapping[str, Callable[[], Environment]]):
    """Variants whose environments a person may end: those that are listed, and those that are not.

    A task may know more variants than it lists, such as one for each file of an arm.
    """

    variants: Mapping[str, Callable[[], Environment]]
    made: Callable[..., Environment]

    def __getitem__(self, name: str) -> Callable[[], Environment]:
        return partial(self.made, self.variants[name])

    def __iter__(self) -> Iterator[str]:
        return iter(self.variants)

    def __len__(self) -> int:
        return len(self.variants)


def _made_inside(make: Callable[[Any], Expert], environment: Environment) -> Expert:
    """An expert looks at the physics, which an operated environment does not show."""
    operated = isinstance(environment, OperatedEnvironment)
    return make(environment.environment if operated else environment)
