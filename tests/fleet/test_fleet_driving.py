"""Four cars and one simulated operator: no failure that one car alone would not have had."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

import sheath_manip.dashboard
from sheath_manip.cli.entry import run_command
from sheath_manip.cli.session import Catalog
from sheath_manip.dashboard import Dashboard
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.fleet.fleet_cockpit import FleetCockpit
from sheath_manip.fleet.urgency import PATIENCE_S
from sheath_manip.playback.film import Film
from sheath_manip.tasks.driving.entry import DRIVING
from sheath_manip.types import Outcome
from tests.waiting import DEADLINE_S, eventually
from tools.fleet_person import Eyes, FleetPerson
from tools.scripted_person import at_the_wheel
from tools.station import Station

pytestmark = [pytest.mark.soak, pytest.mark.timeout(900)]
ROBOTS, EPISODES = 4, 8
SPEED = 0.5
"""times the task's pace, since the software that draws is slow"""
UNSPARED = ("--requests.a-minute", 0, "--requests.an-episode", 0)
"""so that the policy drives as much at one robot as at four: the limits count for each robot, and
who has one alone would keep the wheel once he has been asked three times in a minute"""


def call(*argv: object) -> None:
    words = [str(word) for word in argv]
    assert run_command(lambda: Catalog({"driving": DRIVING}, {}), words) == 0


@contextmanager
def person_at(opened: list[Dashboard]) -> Iterator[list[float]]:
    """A simulated operator at the page that the block opens, in a thread; its turns, in seconds."""
    over, turns_s = threading.Event(), list[float]()

    def run() -> None:
        assert eventually(lambda: bool(opened), 10 * DEADLINE_S)
        page = opened.pop()
        twin = DRIVING.make()

        def film() -> Film | None:
            cockpit = page.cockpit
            return cockpit.roster.shown.film if isinstance(cockpit, FleetCockpit) else page._film

        with Station(page.address) as station:
            eyes = Eyes(twin, DRIVING.make_expert(twin))
            with FleetPerson(station, film, eyes, at_the_wheel) as person:
                over.wait()
            turns_s.extend(person.turns_s)

    thread = threading.Thread(target=run, daemon=True)
    thread.start()
    yield turns_s
    over.set()
    thread.join(DEADLINE_S)
    assert not thread.is_alive()


def lost(store: Path) -> set[int]:
    """The scenes that were no success."""
    summaries = EpisodeStore(store).infos()
    assert len(summaries) == EPISODES
    return {each.info.seed for each in summaries if each.outcome is not Outcome.SUCCESS}


def test_four_cars_lose_no_scene_that_one_alone_would_not_have_lost(tmp_path, monkeypatch):
    opened: list[Dashboard] = []

    class Noted(Dashboard):
        def __init__(self, *args, **options) -> None:
            super().__init__(*args, **options)
            opened.append(self)

    monkeypatch.setattr(sheath_manip.dashboard, "Dashboard", Noted)
    demos, checkpoint = tmp_path / "demos", tmp_path / "first.npz"
    call("collect", "driving", "--store", demos, "--episodes", 6)
    call("train", "driving", "--store", demos, "--calibration", 3, "--checkpoint", checkpoint)
    stores = {robots: tmp_path / f"of-{robots}" for robots in (1, ROBOTS)}
    turns_s: dict[int, list[float]] = {}
    for robots, store in stores.items():
        with person_at(opened) as turns_s[robots]:
            options = ("--expert", "person", "--robots", robots, "--wait-s", 1e6, "--port", 0)
            paced = ("--episodes", EPISODES, "--speed", SPEED, "--store", store)
            call("run", "driving", "--checkpoint", checkpoint, *options, *paced, *UNSPARED)
    assert lost(stores[ROBOTS]) <= lost(stores[1])
    recorded = EpisodeStore(stores[ROBOTS])
    waited_s = [
        step.decision.waited_s for name in recorded.names() for step in recorded.read(name).steps
    ]
    longest_s, turn_s = max(waited_s), max(turns_s[ROBOTS])
    print(f"requests waited at most {longest_s:.1f} s, turns took at most {turn_s:.1f} s")
    assert longest_s <= PATIENCE_S + ROBOTS * turn_s
