"""Rubbish at the page's port: each answer has its headers, and nothing of it is on the terminal."""

import http.client
import json
import random
import socket
from contextlib import suppress
from http import HTTPStatus

import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.typing import Subprotocol

from sheath_manip.dashboard import Dashboard
from tests.waiting import DEADLINE_S
from tools.station import admission, open_socket

REQUESTS = 600
ESCAPE = b"\x1b]0;a stranger\x07\x1b[31mred"
HEADERS = {
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Cache-Control": "no-store",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
}
UPGRADE = "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"


def rubbish(rng: random.Random, host: str) -> bytes:
    """A request that is none, or none of a page."""
    kind = rng.randrange(8)
    if kind == 0:
        return rng.randbytes(rng.randrange(300))
    if kind == 1:
        return ESCAPE + b" / HTTP/1.1\r\n\r\n"
    if kind == 2:
        return b"GET /" + ESCAPE + b" HTTP/1.1\r\nHost: " + ESCAPE + b"\r\n\r\n"
    if kind == 3:
        return b"POST / HTTP/1.1\r\nContent-Length: 9\r\n\r\n" + ESCAPE
    if kind == 4:
        return b"GET / HTTP/1.1\r\n" + b"X" * rng.randrange(20000) + b": 1\r\n"
    if kind == 5:
        key = rng.choice(["", "AAAA", "not base 64 \x1b[0m"])
        lines = f"GET / HTTP/1.1\r\nHost: {host}\r\n{UPGRADE}Sec-WebSocket-Key: {key}\r\n\r\n"
        return lines.encode()
    if kind == 6:
        return b"\x16\x03\x01\x02\x00" + rng.randbytes(200)
    return b""


def send(port: int, raw: bytes) -> None:
    """Say so, and leave at once."""
    with (
        socket.create_connection(("127.0.0.1", port), timeout=DEADLINE_S) as connection,
        suppress(OSError),
    ):
        connection.sendall(raw)


def test_no_rubbish_request_writes_on_the_terminal(
    dashboard: Dashboard, capfd: pytest.CaptureFixture, caplog: pytest.LogCaptureFixture
) -> None:
    rng = random.Random(0)
    access = dashboard._server.access
    for _ in range(REQUESTS):
        send(access.port, rubbish(rng, f"127.0.0.1:{access.port}"))
    # Also of those who are let in: a handshake that is none, a client of another viser.
    admitted = admission(dashboard.address)
    entry = f"Host: 127.0.0.1:{access.port}\r\nCookie: {admitted.cookie}\r\n"
    for key in ("", "AAAA", "\x1b[31m"):
        lines = f"GET {admitted.path} HTTP/1.1\r\n{entry}{UPGRADE}Sec-WebSocket-Key: {key}\r\n\r\n"
        send(access.port, lines.encode())
    other = [Subprotocol("viser-v0.stranger")]
    with (
        open_socket(dashboard.address, "", subprotocols=other) as connection,
        pytest.raises(ConnectionClosed),
    ):
        connection.recv(DEADLINE_S)
    # The server lives, and was done with all of them: it takes requests in their order.
    assert admission(dashboard.address).cookie
    assert capfd.readouterr() == ("", "")
    assert not caplog.records


def test_what_fails_in_the_page_itself_is_told_once_by_the_name_of_its_class(
    dashboard: Dashboard,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture,
    caplog: pytest.LogCaptureFixture,
) -> None:
    def fail(*_: object) -> None:
        raise ArithmeticError(ESCAPE.decode())

    monkeypatch.setattr(dashboard.cockpit, "order", fail)
    for _ in range(3):
        with open_socket(dashboard.address) as station:
            station.send(json.dumps({"order": "pause"}))
            with pytest.raises(ConnectionClosed):
                all(iter(lambda station=station: station.recv(DEADLINE_S), ""))
    assert [each.getMessage() for each in caplog.records] == [
        "a connection to the page failed (ArithmeticError); the run goes on"
    ]
    assert not caplog.records[0].exc_info
    assert capfd.readouterr() == ("", "")


def test_every_answer_has_all_headers(dashboard: Dashboard) -> None:
    admitted, port = admission(dashboard.address), dashboard._server.access.port
    asked = {
        ("/", ""): HTTPStatus.UNAUTHORIZED,
        (f"/{dashboard.address.rpartition('/')[2]}", ""): HTTPStatus.OK,
        ("/nothing", admitted.cookie): HTTPStatus.UNAUTHORIZED,
        (f"{admitted.path}/", admitted.cookie): HTTPStatus.OK,
        (f"{admitted.path}/nothing", admitted.cookie): HTTPStatus.NOT_FOUND,
    }
    answers = []
    for (path, cookie), status in asked.items():
        for host in (f"127.0.0.1:{port}", "evil.example"):
            connection = http.client.HTTPConnection("127.0.0.1", port, timeout=DEADLINE_S)
            connection.request("GET", path, headers={"Cookie": cookie, "Host": host})
            answer = connection.getresponse()
            assert answer.status == (HTTPStatus.FORBIDDEN if host == "evil.example" else status)
            answer.read()
            answers.append((host, dict(answer.getheaders())))
            connection.close()
    with open_socket(dashboard.address) as station:
        assert station.response is not None
        answers.append((f"127.0.0.1:{port}", dict(station.response.headers.raw_items())))
        assert json.loads(station.recv(DEADLINE_S))
    with pytest.raises(InvalidStatus) as refused:
        open_socket(dashboard.address, "/nothing")
    answers.append((f"127.0.0.1:{port}", dict(refused.value.response.headers.raw_items())))
    for host, answered in answers:
        assert HEADERS.items() <= answered.items()
        assert "Server" not in answered
        policy = dict(
            each.split(" ", 1) for each in answered["Content-Security-Policy"].split("; ")
        )
        assert policy["default-src"] == policy["frame-ancestors"] == "'none'"
        assert policy["script-src-attr"] == policy["base-uri"] == policy["form-action"] == "'none'"
        assert "http" not in " ".join(policy.values())
        own = "" if host == "evil.example" else f" ws://{host} wss://{host}"
        assert policy["connect-src"] == f"'self' data: blob:{own}"
