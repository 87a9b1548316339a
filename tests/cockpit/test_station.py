"""The page's own websocket, without a browser: who gets in, who drives, what garbage does."""

import json
import random
import time
from collections.abc import Iterator
from http import HTTPStatus

import msgspec
import pytest
import viser
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect
from websockets.typing import Origin, Subprotocol

from sheath_manip.cockpit import Cockpit, OperatorInput
from sheath_manip.dashboard import Dashboard
from sheath_manip.dashboard.operator_message import LONGEST_MESSAGE
from sheath_manip.dashboard.operator_socket import PATH
from sheath_manip.dashboard.widgets.controls import Controls
from tests.stopwatch import Stopwatch
from tests.toy import Corridor, teleop
from tests.waiting import eventually
from tools.station import Station, admission, open_socket

SUBPROTOCOL = Subprotocol(f"viser-v{viser.__version__}")


@pytest.fixture
def cockpit() -> Cockpit:
    return Cockpit(teleop(Corridor()).guide, paced=True)


@pytest.fixture
def page(cockpit) -> Iterator[Dashboard]:
    with Dashboard(Corridor().spec, port=0, cockpit=cockpit) as page:
        yield page


def given_to(cockpit: Cockpit) -> OperatorInput:
    """What the control loop gets in a step."""
    cockpit.now()
    return cockpit.input


def own_address(page: Dashboard) -> str:
    access = page._server.access
    return f"ws://127.0.0.1:{access.port}{access.path}{PATH}"


def test_it_wants_cookie_and_own_origin(page):
    with pytest.raises(InvalidStatus) as refused:
        connect(own_address(page), proxy=None)
    assert refused.value.response.status_code == HTTPStatus.UNAUTHORIZED
    for origin in ("http://evil.example", "null"):
        with pytest.raises(InvalidStatus) as refused:
            open_socket(page.address, origin=Origin(origin))
        assert refused.value.response.status_code == HTTPStatus.FORBIDDEN
    cookie = {"Cookie": admission(page.address).cookie, "Host": "evil.example"}
    with pytest.raises(InvalidStatus) as refused:
        connect(own_address(page), additional_headers=cookie, proxy=None)
    # The library sends its own Host beside it, and two of them are one too many.
    assert refused.value.response.status_code in (HTTPStatus.FORBIDDEN, HTTPStatus.BAD_REQUEST)


def test_two_stations_cannot_both_drive(page, cockpit):
    with Station(page.address) as one, Station(page.address) as two:
        one.order("take-over")
        one.until(lambda shown: shown.get("mine", False))
        two.order("take-over")
        two.hold(keys=["KeyL"])
        two.order("pause")
        one.hold(keys=["KeyJ"])
        two.until(lambda shown: shown.get("others", False))
        assert eventually(lambda: given_to(cockpit).keys == {"KeyJ"})
        assert not cockpit.paused
        # But anyone may stop.
        two.order("emergency-stop")
        one.until(lambda shown: shown["stopped"])
        # Nobody drives a stopped robot, so anyone may reset it who has seen the stop.
        two.send({"order": "reset-stop", "seen": 0})
        two.send({"order": "reset-stop"})
        time.sleep(0.3)
        assert cockpit.now().stopped
        two.until(lambda shown: shown["stopped"])
        two.order("reset-stop")
        assert eventually(lambda: not cockpit.now().stopped)
        one.until(lambda shown: not shown["stopped"])
        one.order("resume")
        # Who drove has to take over anew, and so may another one.
        two.order("take-over")
        two.until(lambda shown: shown["mine"])


def test_a_station_that_goes_silent_drives_no_more_within_half_a_second(page, cockpit):
    with Station(page.address) as station:
        station.order("take-over")
        station.hold(keys=["KeyJ"])
        assert eventually(lambda: given_to(cockpit).held)
        station.vanish()
        watch = Stopwatch()
        assert eventually(lambda: cockpit.now().input is None)
        assert watch.took_s < 0.5
    # It has left for good now.
    assert eventually(lambda: cockpit.now().abandoned)


def test_only_the_keys_of_the_guide_are_heard(page, cockpit):
    with Station(page.address) as station:
        station.order("take-over")
        station.hold(keys=["KeyJ", "KeyW", "Enter"], axes=(0.5, 0, 0, -1), buttons=(4,))
        assert eventually(lambda: given_to(cockpit).keys == {"KeyJ"})
        pad = cockpit.latest_input.pad
        assert pad is not None
        assert pad.axes == (0.5, 0.0, 0.0, -1.0)
        assert pad.held


def test_a_pages_key_is_its_own(page, cockpit):
    """A key that nobody was given makes nobody another one's station."""
    with Station(page.address) as station:
        station.send({"station": "a guess"})
        station.order("take-over")
        assert eventually(lambda: (cockpit.lease.holder or "").startswith("socket"))


CAMERA = {
    "type": "ViewerCameraMessage",
    "wxyz": [1, 0, 0, 0],
    "position": [0, 0, 1.5],
    "fov": 0.8,
    "near": 0.01,
    "far": 1000,
    "image_height": 900,
    "image_width": 1400,
    "look_at": [0, 0, 0],
    "up_direction": [0, 0, 1],
}
"""with which a browser introduces itself: before it viser listens to no click"""


def garbage(rng: random.Random) -> str | bytes:
    """What no page would send."""
    values = [None, True, -1, 1e308, "x" * 50, [], {}, [[[]]], {"keys": 1}, "emergency-stop\0"]
    kind = rng.randrange(7)
    if kind == 0:
        return rng.randbytes(rng.randrange(200))
    if kind == 1:
        return "".join(chr(rng.randrange(32, 0x3000)) for _ in range(rng.randrange(300)))
    if kind == 2:
        return json.dumps({rng.choice(["keys", "pad", "order", "value", "x"]): rng.choice(values)})
    if kind == 3:
        return "[" * rng.randrange(2 * LONGEST_MESSAGE)
    if kind == 4:
        return json.dumps({"keys": [rng.choice(["KeyJ", "é", ""])] * 13})
    if kind == 5:
        pad = {"axes": [rng.uniform(-9, 9) * 2] * rng.randrange(6), "buttons": [99]}
        return json.dumps({"keys": [], "pad": pad})
    return '{"order": "speed", "value": ' + rng.choice(["NaN", "1e999", "-Infinity", '"1"']) + "}"


def viser_garbage(rng: random.Random, uuids: list[str]) -> bytes:
    """What viser would take: properties that are not a browser's to set, values out of range."""
    uuid = rng.choice([*uuids, "nothing", 3, None])
    names = ["value", "update_cb", "removed", "disabled", "props", "sync_cb", "visible"]
    values = [99.0, -1e9, float("nan"), "x", [1, 2], None, True, {"a": 1}]
    messages = [
        {
            "type": "GuiUpdateMessage",
            "uuid": uuid,
            "updates": {rng.choice(names[1:]): rng.choice(values)},
        },
        {"type": "GuiUpdateMessage", "uuid": uuid, "updates": {"value": [0.5, "x"]}},
        {"type": "GuiUpdateMessage", "uuid": uuid, "updates": rng.choice(values)},
        {"type": "ShareUrlRequest"},
        {"type": "RunJavascriptMessage", "source": "alert(1)"},
        {"type": "FileTransferStartUpload", "source_component_uuid": uuid},
        {"type": "TransformControlsUpdateMessage", "name": "/x", "wxyz": [0] * 4, "position": []},
        {"type": "ViewerCameraMessage", "fov": float("inf")},
        {"type": rng.choice(["", "Message", "ResetGuiMessage", "GuiCloseModalMessage"])},
    ]
    if rng.randrange(4) == 0:
        return rng.randbytes(rng.randrange(300))
    return msgspec.msgpack.encode(rng.choice(messages))


def test_five_hundred_messages_of_garbage_change_nothing_and_stop_nothing(page, cockpit):
    rng = random.Random(0)
    controls = page._page.widget(Controls)
    elements = page._server.viser.gui._gui_input_handle_from_uuid
    before = {uuid: dict(vars(each._impl)) for uuid, each in elements.items()}
    state = cockpit.state
    with (
        open_socket(page.address) as own,
        open_socket(page.address, path="/", subprotocols=[SUBPROTOCOL], max_size=None) as visers,
    ):
        visers.send(msgspec.msgpack.encode(CAMERA))
        for _ in range(250):
            own.send(garbage(rng))
            visers.send(viser_garbage(rng, list(elements)))
        # Both connections live on and are heard: messages are handled in their order.
        own.send(json.dumps({"order": "pause"}))
        assert eventually(lambda: cockpit.paused)
        uuid = controls.pause._impl.uuid
        after = {uuid: dict(vars(each._impl)) for uuid, each in elements.items()}
        click = {"type": "GuiUpdateMessage", "uuid": uuid, "updates": {"value": True}}
        visers.send(msgspec.msgpack.encode(click))
        assert eventually(lambda: not cockpit.paused)
    for uuid, old in before.items():
        new = after[uuid]
        assert {name: repr(value) for name, value in new.items()} == {
            name: repr(value) for name, value in old.items()
        }
    cockpit.now()
    assert cockpit.state == state
    assert cockpit.lease.holder is None


def test_a_value_out_of_range_does_not_reach_the_slider(page, cockpit):
    slider = page._page.widget(Controls).speed
    with open_socket(page.address, path="/", subprotocols=[SUBPROTOCOL], max_size=None) as visers:
        visers.send(msgspec.msgpack.encode(CAMERA))
        for value in (99.0, -1.0, float("nan"), "2", True, [2.0], 2.0):
            update = {"value": value}
            message = {"type": "GuiUpdateMessage", "uuid": slider._impl.uuid, "updates": update}
            visers.send(msgspec.msgpack.encode(message))
        assert eventually(lambda: slider.value == 2.0)
        assert eventually(lambda: cockpit.now() is not None and cockpit.speed == 2.0)
