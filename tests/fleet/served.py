"""A fleet on the toy task, at its page, with one station there."""

import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field

from sheath_manip.cockpit.post import Post
from sheath_manip.dashboard import Dashboard
from sheath_manip.fleet.fleet import Fleet, Ran
from sheath_manip.fleet.fleet_cockpit import FleetCockpit
from sheath_manip.gates.patient import RequestConfig
from sheath_manip.rollout.request import EpisodeRequest
from sheath_manip.types import Step
from tests.toy import CORRIDOR, Corridor, teleop
from tests.waiting import DEADLINE_S, eventually
from tools.station import Station

START_S = 4 * DEADLINE_S
"""in which processes start on a busy machine"""
HANDS = teleop(Corridor())
POST = Post(
    task=CORRIDOR,
    spec=Corridor().spec,
    guide=HANDS.guide,
    dead_man=HANDS.dead_man,
    fallback_shown="scripted expert",
    hold="hold",
    requests=RequestConfig(),
)


@dataclass
class Served:
    """What a test looks at."""

    cockpit: FleetCockpit
    fleet: Fleet
    page: Dashboard
    station: Station
    ran: list[Ran] = field(default_factory=list)
    over: threading.Event = field(default_factory=threading.Event)

    def steps(self, number: int) -> list[Step]:
        film = self.cockpit.roster.seats[number - 1].film
        return [] if film is None else film.steps

    def does(self) -> list[str]:
        return [each.does for each in self.cockpit.state.robots]

    def words(self) -> list[str]:
        return [each.words for each in self.cockpit.state.robots]

    def begin(self) -> None:
        """Let the run begin, once all robots are there."""
        waits = "waiting for you to begin"
        assert eventually(
            lambda: self.over.is_set() or all(words == waits for words in self.words()), START_S
        ), self.words()
        assert not self.over.is_set(), self.ran
        self.station.order("hand-back")


@contextmanager
def served(
    robots: int, requests: Sequence[EpisodeRequest], post: Post = POST, patience_s: float = 60.0
) -> Iterator[Served]:
    cockpit = FleetCockpit(robots, post.guide, post.fallback_shown, patience_s=patience_s)
    with Dashboard(post.spec, port=0, cockpit=cockpit, pictures=cockpit.roster.pictures) as page:
        cockpit.on_film = page.show
        with Station(page.address) as station, Fleet(post, cockpit, page.count) as fleet:
            found = Served(cockpit, fleet, page, station)

            def run() -> None:
                for each in fleet.run(requests):
                    found.ran.append(each)
                found.over.set()

            thread = threading.Thread(target=run, name="fleet", daemon=True)
            thread.start()
            try:
                yield found
            finally:
                fleet.close()
                thread.join(DEADLINE_S)
            assert not thread.is_alive()
