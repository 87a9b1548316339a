"""Options that several verbs share."""

import ipaddress
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

import tyro

from sheath_manip.cli.session import Session
from sheath_manip.task import Task
from sheath_manip.types import TaskSpec

if TYPE_CHECKING:
    from sheath_manip.cockpit import Cockpit
    from sheath_manip.dashboard import Dashboard
    from sheath_manip.dashboard.explainer import Explainer
    from sheath_manip.dashboard.pictures_socket import Pictures
    from sheath_manip.dashboard.widget import WidgetFactory

NOT_LOOPBACK = (
    "Other machines can reach this page. They need the token of the address below, which travels "
    "unencrypted: put a proxy that speaks TLS in front, or forward the port over ssh "
    "(docs/security.md)."
)

TaskName = Annotated[tyro.conf.Positional[str], tyro.conf.arg(metavar="TASK")]
StoreAddress = Annotated[tyro.conf.Positional[str], tyro.conf.arg(metavar="STORE")]
"""a directory or a URL, which a Path would spoil"""
WITHOUT_PREFIX = tyro.conf.arg(name="")
"""of options that are grouped in the program but not on the line"""


def default_is(words: str) -> Any:
    """Return a mark of an option by which its help names its effective default, not None."""
    return tyro.conf.arg(help_behavior_hint=f"(default: {words})")


@dataclass(frozen=True)
class Address:
    """Where the dashboard listens."""

    host: str = "127.0.0.1"
    """address of the page to listen on; other machines reach the page only where it is not the
    loopback's, and then should do so through TLS"""
    port: int = 8080
    """port of the page; 0 takes any free one"""

    @contextmanager
    def dashboard(
        self,
        spec: TaskSpec,
        session: Session,
        cockpit: "Cockpit | None" = None,
        gate: "tuple[WidgetFactory, ...]" = (),
        explainer: "Explainer | None" = None,
        pictures: "Pictures" = dict,
    ) -> Iterator["Dashboard"]:
        """The page, its address printed; taken down at the end. Raises SetupError (port taken).

        `cockpit` is where a person's orders go, `gate` are the sliders of an adjustable gate,
        `explainer` says why it asks, and `pictures` are what each of several robots sees.
        """
        # Only now: it takes seconds, and most calls want no page.
        from sheath_manip.dashboard import Dashboard

        self.warn(session)
        with Dashboard(
            spec,
            host=self.host,
            port=self.port,
            cockpit=cockpit,
            gate=gate,
            explainer=explainer,
            pictures=pictures,
        ) as dashboard:
            session.announce(dashboard.address)
            yield dashboard

    def warn(self, session: Session) -> None:
        """Say what it means where other machines can reach the page."""
        if not is_loopback(self.host):
            session.err.print(f"[bold yellow]{NOT_LOOPBACK}")

    @contextmanager
    def listeners(
        self,
        wanted: bool,
        spec: TaskSpec,
        session: Session,
        explainer: "Explainer | None" = None,
    ) -> Iterator[Sequence["Dashboard"]]:
        """The page as the only listener where it is `wanted`, else none."""
        if not wanted:
            yield ()
            return
        with self.dashboard(spec, session, explainer=explainer) as dashboard:
            yield (dashboard,)


def is_loopback(host: str) -> bool:
    """Whether only this machine reaches `host`."""
    try:
        return host == "localhost" or ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


def spec_of(task: Task) -> TaskSpec:
    """Return what the page must know before there is a run."""
    environment = task.make()
    environment.close()
    return environment.spec
