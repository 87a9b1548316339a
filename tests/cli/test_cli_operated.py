"""The verbs with a person, which here is a program at the page's websocket."""

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

import sheath_manip.dashboard
from sheath_manip.cli.options import is_loopback
from sheath_manip.cockpit import Order
from sheath_manip.dashboard import Dashboard
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.types import Purpose, Reason
from tests.waiting import DEADLINE_S, eventually
from tools.station import Station

JUDGED = ("--evaluation-episodes", 1, "--final-episodes", 1)
SMALL = (
    *("--demonstrations", 3, "--calibration", 3, "--false-alarm-episodes", 1, "--rounds", 1),
    *("--policy.name", "hog-svm", "--gate.signal", "support", "--gate.embedding", "pixels"),
)
"""without a network to train"""


@pytest.fixture
def at_the_page(monkeypatch) -> Callable:
    """`with at_the_page(do):` does it with a station at the page that the block opens."""
    opened: list[Dashboard] = []

    class Noted(Dashboard):
        def __init__(self, *args, **options) -> None:
            super().__init__(*args, **options)
            opened.append(self)

    monkeypatch.setattr(sheath_manip.dashboard, "Dashboard", Noted)

    @contextmanager
    def beside(do: Callable[[Station], None]) -> Iterator[None]:
        def run() -> None:
            assert eventually(lambda: bool(opened))
            with Station(opened[0].address) as station:
                station.until(lambda shown: shown.get("operated", False))
                do(station)
                over.wait(DEADLINE_S)

        over = threading.Event()
        thread = threading.Thread(target=run, daemon=True)
        thread.start()
        yield
        over.set()
        thread.join(DEADLINE_S)
        assert not thread.is_alive()

    return beside


def take_over(station: Station) -> None:
    station.order("take-over")
    # A turn begins with the first key.
    station.hold(keys=["KeyJ"])


def let_it_begin(station: Station) -> None:
    station.until(lambda shown: shown.get("unready", False))
    station.order("hand-back")


def reasons(store: Path) -> list[Reason]:
    found = EpisodeStore(store)
    return [step.decision.reason for name in found.names() for step in found.read(name).steps]


def test_teleop_records_demonstrations_by_hand(sheath, at_the_page, tmp_path):
    store = tmp_path / "store"
    with at_the_page(take_over):
        argv = ("teleop", "corridor", "--store", store, "--episodes", 2, "--port", 0)
        code, out, _ = sheath(*argv)
    assert code == 0
    assert f"in {store}" in out
    summaries = EpisodeStore(store).infos()
    assert [s.info.purpose for s in summaries] == [Purpose.DEMONSTRATION] * 2
    assert {s.info.method for s in summaries} == {"person"}
    assert len({s.info.session for s in summaries} - {""}) == 1
    assert Reason.PERSON in reasons(store)
    assert set(reasons(store)) <= {Reason.PERSON, Reason.IDLE}
    # What is there is not asked for again.
    assert sheath(*argv)[0] == 0


def test_run_asks_a_person_and_falls_back(sheath, made, at_the_page, tmp_path):
    store = tmp_path / "store"
    argv = ("run", "corridor", "--checkpoint", made / "first.npz", "--episodes", 3, "--port", 0)
    person = ("--expert", "person", "--store", store, "--wait-s", 0.04, "--fallback", "hold")
    with at_the_page(let_it_begin):
        code, out, _ = sheath(*argv, *person)
    assert code == 0
    assert "3 episodes" in out
    assert {s.info.method.rpartition("-")[2] for s in EpisodeStore(store).infos()} == {"person"}
    assert Reason.PERSON not in reasons(store)
    # To wait takes no step: what the robot waited for in vain is in the step after it.
    assert {Reason.INSIDE, Reason.NO_ANSWER} <= set(reasons(store))
    assert Reason.WAITING not in reasons(store)
    assert "seconds waited" in out


def test_a_simulated_person_answers_and_what_was_asked_is_printed(sheath, made, tmp_path):
    argv = ("run", "corridor", "--checkpoint", made / "first.npz", "--episodes", 3)
    person = ("--expert", "simulated-person", "--simulated.reaction-s", 0.5)
    code, out, _ = sheath(*argv, *person, "--store", tmp_path / "first")
    assert code == 0
    for burden in ("requests a minute", "requests an episode", "median turn, s", "seconds driven",
                   "seconds waited", "labels", "failed", "stuck"):  # fmt: skip
        assert burden in out
    assert Reason.PERSON in reasons(tmp_path / "first")
    # The same person again does the same.
    assert sheath(*argv, *person, "--store", tmp_path / "again")[0] == 0
    assert reasons(tmp_path / "first") == reasons(tmp_path / "again")
    # Of a scripted expert the same is told.
    assert "requests a minute" in sheath(*argv)[1]


def test_a_persons_run_has_the_gates_sliders(sheath, made, monkeypatch, tmp_path):
    """At a threshold that a person has moved up no state is inside."""
    sliders: list[int] = []

    class Noted(Dashboard):
        def __init__(self, spec, *, gate=(), **options) -> None:
            super().__init__(spec, gate=gate, **options)
            dial = gate[0].keywords["dial"]
            sliders.append(len(gate))
            dial.boundary = dial.boundary.at(np.finfo(float).max)
            threading.Thread(target=self.begin, daemon=True).start()

        def begin(self) -> None:
            assert eventually(lambda: self.cockpit.state.unready)
            self.cockpit.order(Order.HAND_BACK, "the test")

    monkeypatch.setattr(sheath_manip.dashboard, "Dashboard", Noted)
    argv = ("run", "corridor", "--checkpoint", made / "first.npz", "--episodes", 1, "--port", 0)
    person = ("--expert", "person", "--wait-s", 0, "--fallback", "hold")
    store = tmp_path / "store"
    assert sheath(*argv, *person, "--store", store)[0] == 0
    assert set(reasons(store)) == {Reason.NO_ANSWER}
    assert sheath(*argv, *person, "--training-store", made / "store")[0] == 0
    assert sliders == [1, 2]


def test_learn_with_a_person(sheath, at_the_page, tmp_path):
    runs = tmp_path / "runs"
    argv = ("learn", "corridor", "--runs", runs, *SMALL, "--port", 0)
    person = ("--expert", "person", "--wait-s", 20)
    with at_the_page(take_over):
        code, out, _ = sheath(*argv, "--episodes", 2, *JUDGED, *person)
    assert code == 0
    assert (runs / "s0" / "sheath-own-labels" / "round-01.npz").exists()
    assert "takeovers an episode" in out
    store = EpisodeStore(runs / "store")
    learning = [s for s in store.infos() if s.info.purpose is Purpose.LEARNING]
    assert len(learning) == 2
    acted = {step.decision.reason for s in learning for step in store.read(s.name).steps}
    assert Reason.PERSON in acted
    # By hand, as nobody does it again; the scripted expert's are the same each time.
    assert len({s.info.session for s in learning} - {""}) == 1
    assert {s.info.session for s in store.infos() if s.info.purpose is not Purpose.LEARNING} == {""}


def test_learn_with_the_scripted_expert(sheath, tmp_path):
    runs = tmp_path / "runs"
    argv = ("learn", "corridor", "--runs", runs, *SMALL)
    rest = ("--episodes", 1, *JUDGED, "--method", "sheath")
    assert sheath(*argv, *rest)[0] == 0
    # Stopped and called again it has nothing left to do, and says the same.
    assert sheath(*argv, *rest)[0] == 0


def test_what_is_for_a_person_wants_one(complaint, made):
    run = ("run", "corridor", "--checkpoint", made / "first.npz")
    assert "--expert person" in complaint(*run, "--wait-s", 3)
    assert "--expert person" in complaint(*run, "--training-store", made / "store")
    assert "a policy alone" in complaint(*run, "--expert", "person", "--policy-alone")
    said = complaint(*run, "--expert", "person", "--fallback", "nobody", "--port", 0)
    assert "unknown expert of corridor 'nobody'; known: hold, scripted" in said
    simulated = (*run, "--expert", "simulated-person")
    assert "--speed 2.0 is for a person" in complaint(*simulated, "--speed", 2)
    assert "a policy alone" in complaint(*simulated, "--policy-alone")
    assert "reaction_s is 0" in complaint(*simulated, "--simulated.reaction-s", 0)
    assert "--simulated is for one" in complaint(*run, "--simulated.reaction-s", 2)
    assert "--requests is for a person" in complaint(*run, "--requests.turn-s", 3)
    assert "wait_s is -1" in complaint(*run, "--expert", "person", "--wait-s", -1, "--port", 0)
    assert "pyspacemouse" in complaint(
        "teleop", "corridor", "--store", "x", "--spacemouse", "--port", 0
    )


def test_a_host_that_others_reach_is_warned_of(sheath):
    argv = ("dashboard", "corridor", "--episodes", 1, "--speed", 50, "--port", 0)
    _, _, err = sheath(*argv, "--host", "0.0.0.0")
    assert "TLS" in err
    assert "token" in err
    assert "TLS" not in sheath(*argv)[2]
    assert is_loopback("::1")
    assert is_loopback("127.0.0.2")
    assert not is_loopback("robot.local")
