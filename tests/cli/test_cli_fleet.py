"""`sheath run --robots`: what is printed and recorded of several robots, and what is refused."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

import sheath_manip.dashboard
from sheath_manip.dashboard import Dashboard
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.fleet.fleet_cockpit import FleetCockpit
from sheath_manip.rollout.simulated_operator import OperatorConfig
from sheath_manip.types import Reason
from tests.fleet.drifting import sidestep
from tests.toy import Corridor, MiddleKeeper
from tests.waiting import DEADLINE_S, eventually
from tools.fleet_person import Eyes, FleetPerson
from tools.station import Station

QUICK = OperatorConfig(reaction_s=0.05, reaction_spread_s=0.0, attention_s=0.1)


@pytest.fixture
def person_at_the_page(monkeypatch):
    """`with person_at_the_page():` has one serve the page that the block opens."""
    opened: list[Dashboard] = []

    class Noted(Dashboard):
        def __init__(self, *args, **options) -> None:
            super().__init__(*args, **options)
            opened.append(self)

    monkeypatch.setattr(sheath_manip.dashboard, "Dashboard", Noted)

    @contextmanager
    def beside() -> Iterator[None]:
        def run() -> None:
            assert eventually(lambda: bool(opened))
            cockpit = opened[0].cockpit
            assert isinstance(cockpit, FleetCockpit)
            twin = Corridor()
            eyes = Eyes(twin, MiddleKeeper(twin))
            with (
                Station(opened[0].address) as station,
                FleetPerson(station, lambda: cockpit.roster.shown.film, eyes, sidestep, QUICK),
            ):
                over.wait()

        over = threading.Event()
        thread = threading.Thread(target=run, daemon=True)
        thread.start()
        yield
        over.set()
        thread.join(DEADLINE_S)
        assert not thread.is_alive()

    return beside


def test_two_robots_are_recorded_in_one_store_and_counted_apart(
    sheath, made, person_at_the_page, tmp_path
):
    store = tmp_path / "store"
    argv = ("run", "corridor", "--checkpoint", made / "first.npz", "--episodes", 3, "--port", 0)
    person = ("--expert", "person", "--robots", 2, "--store", store, "--speed", 0.5)
    with person_at_the_page():
        code, out, err = sheath(*argv, *person)
    assert code == 0, err
    assert "3 episodes" in out
    heading = next(line for line in out.splitlines() if "robot 1" in line)
    assert heading.split() == ["robot", "1", "robot", "2", "all"]
    told = {line[:16].strip(): line[16:].split() for line in out.splitlines()}
    for burden in ("requests", "seconds waited", "seconds driven", "labels"):
        assert len(told[burden]) == 3
    recorded = EpisodeStore(store)
    infos = [each.info for each in recorded.infos()]
    assert len({each.seed for each in infos}) == 3
    assert {each.method.rpartition("-")[2] for each in infos} == {"person"}
    steps = [step for name in recorded.names() for step in recorded.read(name).steps]
    assert not {Reason.WAITING, Reason.NO_ANSWER} & {step.decision.reason for step in steps}
    # The same scenes as of one robot alone, and what is there is not asked for again.
    alone = tmp_path / "alone"
    assert sheath(*argv, "--store", alone)[0] == 0
    assert {each.info.seed for each in EpisodeStore(alone).infos()} == {each.seed for each in infos}
    assert sheath(*argv, *person)[0] == 0


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--robots", 0), "robots is 0; wanted at least 1"),
        (("--robots", 4), "--robots 4 is for a person; wanted --expert person, or without one "),
        (("--robots", 4, "--expert", "hold"), "`sheath evaluate --workers 4`"),
        (
            ("--robots", 4, "--expert", "person", "--episodes", 2),
            "robots is 4, and episodes 2; wanted at least one episode for each",
        ),
        (("--robots", 2, "--expert", "person", "--wait-s", -1), "wait_s is -1"),
    ],
)
def test_what_no_fleet_can_do_is_refused_in_a_line(complaint, made, options, said):
    argv = ("run", "corridor", "--checkpoint", made / "first.npz", "--port", 0)
    assert said in complaint(*argv, *options)
