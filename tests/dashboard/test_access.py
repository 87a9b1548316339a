import http.client
import socket
from http import HTTPStatus
from urllib.parse import urlsplit

import msgspec
import pytest
import viser
import viser._viser
from viser._messages import ShareUrlDisconnect, ShareUrlRequest
from websockets.datastructures import Headers
from websockets.exceptions import InvalidStatus
from websockets.http11 import Request
from websockets.sync.client import ClientConnection, connect
from websockets.typing import Origin, Subprotocol

from sheath_manip.cockpit import Cockpit
from sheath_manip.dashboard import Dashboard
from sheath_manip.dashboard.access import COOKIE, AccessControl
from sheath_manip.dashboard.server import GuardedServer
from sheath_manip.dashboard.widgets.controls import Controls
from sheath_manip.exceptions import ParameterError, SetupError
from tests.waiting import DEADLINE_S, eventually


def port_of(dashboard: Dashboard) -> int:
    port = urlsplit(dashboard.address).port
    assert port is not None
    return port


def get(
    dashboard: Dashboard, path: str = "/", **headers: str
) -> tuple[http.client.HTTPResponse, bytes]:
    connection = http.client.HTTPConnection("127.0.0.1", port_of(dashboard), timeout=DEADLINE_S)
    try:
        connection.request("GET", path, headers=headers)
        response = connection.getresponse()
        return response, response.read()
    finally:
        connection.close()


def cookie_of(dashboard: Dashboard, token: str) -> str:
    response, _ = get(dashboard, f"/?token={token}")
    return (response.getheader("Set-Cookie") or "").partition(";")[0]


def own_path(dashboard: Dashboard) -> str:
    return dashboard._server.access.path


def open_socket(
    dashboard: Dashboard,
    host: str | None = None,
    origin: str | None = None,
    cookie: str | None = None,
    query: str = "",
    path: str | None = None,
) -> ClientConnection:
    port = port_of(dashboard)
    below = own_path(dashboard) if path is None else path
    return connect(
        f"ws://{host or f'127.0.0.1:{port}'}{below}{query}",
        sock=socket.create_connection(("127.0.0.1", port)),
        origin=None if origin is None else Origin(origin),
        additional_headers={} if cookie is None else {"Cookie": cookie},
        subprotocols=[Subprotocol(f"viser-v{viser.__version__}")],
        max_size=None,
        proxy=None,
        open_timeout=DEADLINE_S,
    )


def assert_refused(dashboard: Dashboard, status: HTTPStatus, **how: str | None) -> None:
    with pytest.raises(InvalidStatus) as refusal:
        open_socket(dashboard, **how)  # type: ignore[arg-type]
    assert refusal.value.response.status_code == status
    assert not dashboard._server.viser._websock_server._client_state_from_id


def test_websocket_without_cookie_is_unauthorized(dashboard: Dashboard, token: str) -> None:
    assert_refused(dashboard, HTTPStatus.UNAUTHORIZED)
    assert_refused(dashboard, HTTPStatus.UNAUTHORIZED, cookie="sheath=1; other=2")
    assert_refused(dashboard, HTTPStatus.UNAUTHORIZED, query=f"?token={token}")
    assert_refused(dashboard, HTTPStatus.UNAUTHORIZED, cookie=f"sheath={token}")


def test_the_cookie_lets_nobody_in_beside_its_path(dashboard: Dashboard, token: str) -> None:
    cookie, path = cookie_of(dashboard, token), own_path(dashboard)
    for elsewhere in (
        "/",
        "/keys",
        path[:-1],
        f"{path}x",
        f"{path.upper()}/",
        f"/x{path}",
    ):
        assert_refused(dashboard, HTTPStatus.UNAUTHORIZED, cookie=cookie, path=elsewhere)
    for elsewhere in ("/", "/index.html"):
        assert get(dashboard, elsewhere, Cookie=cookie)[0].status == HTTPStatus.UNAUTHORIZED
    assert get(dashboard, f"{path}/../x", Cookie=cookie)[0].status == HTTPStatus.NOT_FOUND


def test_nothing_of_one_run_opens_the_next_one_whose_token_is_the_same(token: str) -> None:
    one, two = (AccessControl("127.0.0.1", 80, token) for _ in range(2))
    assert one.path != two.path
    assert one.cookie != two.cookie
    assert len(one.path) > 16
    for secret in (one.path, one.cookie, token):
        assert secret not in repr(one)


def test_websocket_of_another_site_is_forbidden(dashboard: Dashboard, token: str) -> None:
    cookie = cookie_of(dashboard, token)
    for origin in ("http://evil.example", "null", "http://127.0.0.1:1"):
        assert_refused(dashboard, HTTPStatus.FORBIDDEN, origin=origin, cookie=cookie)


def test_websocket_under_a_foreign_name_is_forbidden(dashboard: Dashboard, token: str) -> None:
    cookie, port = cookie_of(dashboard, token), port_of(dashboard)
    for host in (f"evil.example:{port}", "127.0.0.1:1", "127.0.0.1"):
        assert_refused(dashboard, HTTPStatus.FORBIDDEN, host=host, cookie=cookie)
    name = f"evil.example:{port}"
    assert_refused(
        dashboard, HTTPStatus.FORBIDDEN, host=name, origin=f"http://{name}", cookie=cookie
    )


def test_websocket_with_cookie_is_accepted(dashboard: Dashboard, token: str) -> None:
    cookie, port = cookie_of(dashboard, token), port_of(dashboard)
    for host in ("127.0.0.1", "localhost"):
        name = f"{host}:{port}"
        with open_socket(
            dashboard, host=name, origin=f"http://{name}", cookie=f"a=b; {cookie}"
        ) as connection:
            assert connection.recv(timeout=DEADLINE_S)


def test_page_needs_token_or_cookie(dashboard: Dashboard, token: str) -> None:
    assert get(dashboard)[0].status == HTTPStatus.UNAUTHORIZED
    assert get(dashboard, "/?token=wrong-token")[0].status == HTTPStatus.UNAUTHORIZED
    assert get(dashboard, "/?token=")[0].status == HTTPStatus.UNAUTHORIZED
    assert get(dashboard, Host="evil.example")[0].status == HTTPStatus.FORBIDDEN
    path = own_path(dashboard)
    assert get(dashboard, f"{path}/")[0].status == HTTPStatus.UNAUTHORIZED

    welcome, _ = get(dashboard, f"/?token={token}")
    assert welcome.status == HTTPStatus.OK
    attributes = (welcome.getheader("Set-Cookie") or "").split("; ")
    assert {"HttpOnly", "SameSite=Strict", f"Path={path}"} <= set(attributes)
    assert attributes[0].startswith("sheath=")
    assert token not in attributes[0] + path

    response, page = get(dashboard, f"{path}/", Cookie=attributes[0])
    assert response.status == HTTPStatus.OK
    assert b"<html" in page


def test_query_never_reaches_the_page(dashboard: Dashboard, token: str) -> None:
    cookie, path = cookie_of(dashboard, token), own_path(dashboard)
    query = "?websocket=ws://evil.example"
    assert get(dashboard, f"/{query}", Cookie=cookie)[0].status == HTTPStatus.UNAUTHORIZED
    assert get(dashboard, f"{path}{query}")[0].status == HTTPStatus.UNAUTHORIZED
    for own in (path, f"{path}/"):
        response, body = get(dashboard, own + query, Cookie=cookie)
        # To the bare page, as viser's own addition to the address does when it is loaded anew.
        assert response.status == HTTPStatus.OK
        assert f'location.replace("{path}")'.encode() in body
        assert b"evil" not in body
        assert len(body) < 200
    assert_refused(dashboard, HTTPStatus.UNAUTHORIZED, cookie=cookie, query=query)


def test_share_is_refused(
    dashboard: Dashboard, token: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = []
    monkeypatch.setattr(viser._viser, "ViserTunnel", lambda *_: asked.append(True))
    with open_socket(dashboard, cookie=cookie_of(dashboard, token)) as connection:
        connection.recv(timeout=DEADLINE_S)
        connection.send(msgspec.msgpack.encode({"type": "ShareUrlRequest"}))
        # Messages are handled in their order, so once this one is, so was the one before.
        button = dashboard._page.widget(Controls).pause
        click = {"type": "GuiUpdateMessage", "uuid": button._impl.uuid, "updates": {"value": True}}
        connection.send(msgspec.msgpack.encode(click))
        assert eventually(lambda: button.value)
    dashboard._server.viser._thread_executor.submit(lambda: None).result(DEADLINE_S)
    assert not asked
    assert not {ShareUrlRequest, ShareUrlDisconnect} & set(
        dashboard._server.viser._websock_server._incoming_handlers
    )
    with pytest.raises(SetupError, match="tunnel"):
        dashboard._server.viser.request_share_url()


def test_taken_port_is_an_error(dashboard: Dashboard) -> None:
    port = port_of(dashboard)
    with pytest.raises(SetupError, match=f"127.0.0.1:{port} .*--port 0 for any"):
        GuardedServer.open("127.0.0.1", port, None, "second", Cockpit())


def test_foreign_address_is_an_error() -> None:
    with pytest.raises(SetupError, match=r"192\.0\.2\.1:0"):
        GuardedServer.open("192.0.2.1", 0, None, "elsewhere", Cockpit())


def test_short_token_is_an_error() -> None:
    with pytest.raises(ParameterError, match="6 characters; wanted at least 8"):
        GuardedServer.open("127.0.0.1", 0, "secret", "short", Cockpit())


def test_serve_is_unwrapped_after_the_start(dashboard: Dashboard) -> None:
    import websockets.asyncio.server as server

    assert dashboard.address
    assert server.serve.__module__ == "websockets.asyncio.server"


@pytest.mark.parametrize(
    ("bound", "asked", "admitted"),
    [
        ("0.0.0.0", "192.168.1.5:80", True),
        ("0.0.0.0", "192.168.1.5", True),
        ("0.0.0.0", "evil.example", False),
        ("127.0.0.1", "192.168.1.5", False),
        ("127.0.0.1", "LocalHost", True),
        ("Robot.local", "robot.local:80", True),
        ("::1", "[::1]", True),
        ("::1", "[::1]:80", True),
        ("::1", "[::1]:81", False),
        ("127.0.0.1", "", False),
        ("0.0.0.0", ":80", False),
        # A zone is an interface of the machine that asks, and free text.
        ("0.0.0.0", "[::ffff:127.0.0.1%25eth0]", False),
        ("0.0.0.0", "[fe80::1%eth0]:80", False),
        ("::", "[fe80::1%25<b>]:80", False),
        ("::", "[fe80::1]:80", True),
        ("0.0.0.0", "[[127.0.0.1]]", False),
        ("0.0.0.0", "127.0.0.1]", False),
        ("0.0.0.0", "127.0.0.1:80:80", False),
    ],
)
def test_hosts_admitted(bound: str, asked: str, admitted: bool) -> None:
    access = AccessControl(bound, 80, "a-token-for-tests")
    cookie = f"{COOKIE}={access.cookie}"
    answer = access.answer(Request(access.path, Headers(Host=asked, Cookie=cookie)))
    assert (answer is None) == admitted


def test_two_hosts_are_forbidden() -> None:
    headers = Headers([("Host", "localhost:80"), ("Host", "localhost:80")])
    answer = AccessControl("127.0.0.1", 80, "a-token-for-tests").answer(Request("/", headers))
    assert answer is not None
    assert answer.status_code == HTTPStatus.FORBIDDEN
