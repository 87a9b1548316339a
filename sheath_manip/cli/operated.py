"""Options and parts of a run whose expert is a person at the page."""

from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager, ExitStack, contextmanager, nullcontext
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Annotated

from sheath_manip.cli.options import Address, default_is
from sheath_manip.cli.session import Session
from sheath_manip.cockpit import Cockpit
from sheath_manip.cockpit.gate import WAIT_S
from sheath_manip.cockpit.operated_task import operated
from sheath_manip.exceptions import ParameterError
from sheath_manip.gates.patient import FOR_PEOPLE, RequestConfig
from sheath_manip.playback.labels import FALLBACK
from sheath_manip.protocols import Listener
from sheath_manip.rollout.pacing import Pacing
from sheath_manip.rollout.request import Driver, TimedDriver
from sheath_manip.rollout.watch import Deadline
from sheath_manip.task import HOLD, SCRIPTED, Task

if TYPE_CHECKING:
    from sheath_manip.cockpit.post import Post
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
    wait_s: Annotated[
        float | None, default_is(f"{WAIT_S:g}, with several robots as long as it takes")
    ] = None
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
        deadline = self._deadline(paced)
        return driver if deadline is None else TimedDriver(driver, deadline)

    def _deadline(self, paced: bool) -> Deadline | None:
        share = float(paced) if self.deadline is None else self.deadline
        return None if share == 0 else Deadline(share / self.speed)

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
        wait_s = WAIT_S if self.wait_s is None else self.wait_s
        answered = AnsweredDriver(driver, operator, self.fallback, wait_s, self.requests)
        return self.timed(answered, paced=False)

    def post(self, task: Task, wait_s: float) -> "Post":
        """Return how a person drives `task`, waited for `wait_s` unless the line says otherwise.

        Raises ParameterError for a task that nobody can drive, and for a wait below 0.
        """
        if task.teleop is None:
            raise ParameterError(f"nobody can drive {task.name} by hand; wanted a task with teleop")
        # Only now: it brings the gates.
        from sheath_manip.cockpit.post import Post

        wait_s = wait_s if self.wait_s is None else self.wait_s
        if not wait_s >= 0:
            raise ParameterError(f"wait_s is {wait_s}; wanted at least 0, such as {WAIT_S:g}")
        probe = task.make()
        spec, hands = probe.spec, task.teleop(probe)
        task.make_expert(probe, self.fallback)
        probe.close()
        stated = "scripted expert" if self.fallback == SCRIPTED else f"{FALLBACK} “{self.fallback}”"
        return Post(
            task=task,
            spec=spec,
            guide=hands.guide,
            planar=hands.planar,
            dead_man=hands.dead_man,
            fallback=self.fallback,
            fallback_shown=stated,
            hold=HOLD if HOLD in task.fallbacks else None,
            wait_s=wait_s,
            requests=self.requests,
            speed=self.speed,
            deadline=self._deadline(paced=True),
        )

    def devices(self, cockpit: Cockpit) -> AbstractContextManager[object]:
        """Return what reads the devices that are plugged in here, if any is to be."""
        if not self.spacemouse:
            return nullcontext()
        # Only now: it is an extra.
        from sheath_manip.cockpit.spacemouse import SpaceMouse

        return SpaceMouse(cockpit)

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
        post = self.post(task, WAIT_S)
        cockpit = post.cockpit()
        pacing = Pacing(self.speed, lambda: cockpit.speed)
        with ExitStack() as stack:
            stack.enter_context(self.devices(cockpit))
            page = stack.enter_context(
                address.dashboard(post.spec, session, cockpit, gate, explainer)
            )
            yield Crew(post, cockpit, (page, pacing))


@dataclass(frozen=True, eq=False)
class Crew:
    """Who may act in a run that a person operates."""

    post: "Post"
    cockpit: Cockpit
    listeners: Sequence[Listener]
    """the page, then the pacing"""

    @property
    def page(self) -> "Dashboard":
        """The page."""
        return self.listeners[0]  # pyright: ignore[reportReturnType]

    def operated(self) -> Task:
        """Return the task, with episodes that the person may end."""
        return operated(self.post.task, self.cockpit)

    def driver(self, driver: Driver) -> Driver:
        """Return `driver` with the person beside it, and with a deadline."""
        return self.post.driver(driver, self.cockpit)
