"""Four robots without processes: they say what a test has them say, and keep what they are told."""

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

from playwright.sync_api import Page

from sheath_manip.cockpit import OperatorInput, Order
from sheath_manip.cockpit.question import Question
from sheath_manip.cockpit.shown import Shown
from sheath_manip.cockpit.state import State
from sheath_manip.dashboard import Dashboard
from sheath_manip.fleet.fleet_cockpit import FleetCockpit
from sheath_manip.fleet.from_robot import Asked, Begun, Report
from sheath_manip.fleet.outbox import Outbox
from sheath_manip.fleet.to_robot import Ordered
from sheath_manip.playback.film import film_begun
from sheath_manip.types import Actor, EpisodeInfo, GateDecision, Purpose, Reason
from tests.toy import Corridor, teleop

LEFT = OperatorInput(keys=frozenset({"KeyJ"}))
DRIVES = State(operated=True)
ASKS = State(operated=True, turn=Actor.HOLD, asking=True, may_go_on=False)
SERVED = replace(ASKS, taken=True, asking=False, operator="page")


class Told(Outbox):
    """Keeps what is said to a robot."""

    def __init__(self) -> None:
        self.said: list = []

    def put(self, message: object) -> None:
        self.said.append(message)

    def orders(self) -> list[Order]:
        return [each.order for each in self.said if isinstance(each, Ordered)]


class Robots:
    """Four robots that say what a test has them say."""

    def __init__(self, **options) -> None:
        self.cockpit = FleetCockpit(4, teleop(Corridor()).guide, "script", **options)
        self.corridor = Corridor()
        self.told = [Told() for _ in range(4)]
        self.films: list = []
        self.cockpit.on_film = self.films.append
        for seat, told in zip(self.cockpit.roster.seats, self.told, strict=True):
            self.cockpit.attach(seat, told)
            info = EpisodeInfo("corridor", seat.number, Purpose.LEARNING, 50.0)
            self.seen = self.corridor.reset(seat.number)
            film = film_begun(self.corridor, info)
            self.cockpit.hear(seat, Begun(info, film.scene, film.first_pose, ""))
            self.says(seat.number, DRIVES)

    def says(self, number: int, state: State, below: float | None = None) -> None:
        seat = self.cockpit.roster.seats[number - 1]
        if below is not None:
            decision = GateDecision(Actor.EXPERT, True, Reason.OUTSIDE, -below, 0.0)
            self.cockpit.hear(seat, Asked(Question(self.seen, None, decision)))
        self.cockpit.hear(seat, Report(time.monotonic(), state, False, None))

    def asks(self, number: int, below: float = 0.1) -> None:
        self.says(number, ASKS, below)

    @property
    def shown(self) -> int:
        return self.cockpit.state.robot

    def order(
        self,
        order: Order,
        station: str = "page",
        value: float = 1.0,
        seen: int | None = None,
        robot: int | None = None,
    ) -> bool:
        return self.cockpit.order(order, station, value, Shown(seen, robot))


@contextmanager
def served_at(robots: Robots, states: dict[int, State]) -> Iterator[Dashboard]:
    """Their page, while they say again and again what `states` has."""
    over = threading.Event()

    def report() -> None:
        while not over.wait(0.1):
            for number, state in states.items():
                robots.says(number, state)

    with Dashboard(
        Corridor().spec,
        port=0,
        cockpit=robots.cockpit,
        pictures=robots.cockpit.roster.pictures,
    ) as page:
        robots.cockpit.on_film = page.show
        thread = threading.Thread(target=report, daemon=True)
        thread.start()
        yield page
        over.set()
        thread.join()


def words(page: Page) -> list[str]:
    return page.locator("#sheath-robots span").all_inner_texts()


def notice(page: Page) -> str:
    return page.locator("#sheath-operator").inner_text()
