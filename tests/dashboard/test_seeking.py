"""What a page may say to move in time, and what becomes of it."""

import pytest

from sheath_manip.cockpit import Cockpit, Order
from sheath_manip.dashboard import Dashboard
from sheath_manip.dashboard.playhead import Playhead
from sheath_manip.dashboard.seek_socket import LONGEST_MESSAGE, SeekMessage, _follow, _said
from sheath_manip.dashboard.seeking import RunSeeking
from sheath_manip.playback.film import film_of
from sheath_manip.types.operator_input import Binding
from tests.dashboard.conftest import SPEC, TOKEN, RingRoad, drive, play


@pytest.mark.parametrize(
    "raw",
    [
        b"{}",
        "",
        "[]",
        '{"step": 1.5}',
        '{"step": 1e30}',
        '{"episode": -1}',
        '{"other": 1}',
        '{"key": "' + 30 * "x" + '"}',
        '{"note": "' + 300 * "x" + '"}',
        "[" * 1000,
        " " * (LONGEST_MESSAGE + 1),
    ],
)
def test_what_is_no_message_is_not_heard(raw: str | bytes) -> None:
    assert _said(raw) is None


def test_a_message_moves_the_target() -> None:
    heard: list[object] = []

    class Target:
        def __getattr__(self, name: str):
            return lambda value: heard.append((name, value))

    for raw in ('{"step": 3}', '{"nudge": -1}', '{"key": "stop"}', '{"note": "a"}', "{}"):
        said = _said(raw)
        assert isinstance(said, SeekMessage)
        _follow(Target(), said)  # pyright: ignore[reportArgumentType]
    assert heard == [("look_at", 3), ("nudge", -1), ("press", "stop"), ("note", "a")]


def test_a_run_is_looked_back_into_within_its_steps() -> None:
    playhead = Playhead(lambda: None)
    seeking = RunSeeking(playhead)
    seeking.nudge(1)
    assert playhead.shown is None
    playhead.load(film_of(RingRoad(), drive(RingRoad(), 20)))
    for step, shown in ((5, 5), (99, 19), (-3, 0)):
        seeking.look_at(step)
        assert playhead.shown is not None
        assert playhead.shown[1:] == (shown, False)
    seeking.nudge(2)
    seeking.press("stop")
    seeking.load(0, 3)
    seeking.note("")
    assert playhead.shown is not None
    assert playhead.shown[1] == 2


def test_nobody_drives_by_the_past() -> None:
    cockpit = Cockpit((Binding(("KeyI",), "on"),), clock=lambda: 0.0)
    with Dashboard(SPEC, port=0, token=TOKEN, cockpit=cockpit) as dashboard:
        play(dashboard, RingRoad(), drive(RingRoad(), 20))

        def shown() -> tuple[int, bool]:
            snapshot = dashboard._latest()
            assert snapshot is not None
            return snapshot.at, snapshot.present

        dashboard._playhead.look_at(3)
        assert shown() == (3, False)
        assert cockpit.order(Order.TAKE_OVER, "somebody")
        assert shown() == (19, True)
        dashboard._playhead.look_at(3)
        assert shown() == (19, True)
