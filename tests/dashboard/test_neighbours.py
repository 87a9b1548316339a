"""Two servers on neighbouring ports of one machine, and their users' browsers: none acts on both.

A browser sends the cookies of a host to each of its ports. So whose page is opened at another port
must not be given what lets it in here.
"""

import json
import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import pytest
from playwright.sync_api import BrowserContext, Page

from sheath_manip.cockpit import Cockpit
from sheath_manip.dashboard import Dashboard
from sheath_manip.exceptions import SetupError
from tests.toy import Corridor, teleop
from tests.waiting import DEADLINE_S
from tools.chromium import TIMEOUT_S, chromium_page, open_dashboard, wait_until
from tools.station import admission

pytestmark = pytest.mark.browser


@dataclass
class Robot:
    """One user's run."""

    page: Dashboard
    cockpit: Cockpit

    @property
    def port(self) -> int:
        return self.page._server.access.port


@contextmanager
def robot(port: int = 0) -> Iterator[Robot]:
    cockpit = Cockpit(teleop(Corridor()).guide, paced=True)
    with Dashboard(Corridor().spec, port=port, cockpit=cockpit) as page:
        yield Robot(page, cockpit)


def free_neighbour(port: int) -> int:
    """The next port that nobody has."""
    for other in range(port + 1, port + 50):
        with socket.socket() as trial:
            if trial.connect_ex(("127.0.0.1", other)):
                return other
    raise SetupError(f"no free port after {port}")


@pytest.fixture(scope="module")
def first() -> Iterator[Robot]:
    with robot() as first:
        yield first


@pytest.fixture(scope="module")
def second(first) -> Iterator[Robot]:
    with robot(free_neighbour(first.port)) as second:
        yield second


@pytest.fixture(scope="module")
def contexts() -> Iterator[list[BrowserContext]]:
    """Of two users."""
    with chromium_page() as page:
        browser = page.context.browser
        assert browser is not None
        yield [browser.new_context(viewport={"width": 400, "height": 300}) for _ in range(2)]


def opened(context: BrowserContext, robot: Robot) -> Page:
    page = context.new_page()
    page.set_default_timeout(1000 * TIMEOUT_S)
    open_dashboard(page, robot.page.address)
    page.wait_for_function("window.sheathOperator?.state.operated")
    return page


def test_each_page_acts_on_its_own_robot_alone(first, second, contexts):
    for mine, other, visitors in (
        (first, second, contexts[0]),
        (second, first, contexts[1]),
        # One browser at both.
        (second, first, contexts[0]),
    ):
        page = opened(visitors, mine)
        for key, acted in (
            ("t", lambda robot: robot.cockpit.state.taken),
            ("p", lambda robot: robot.cockpit.paused),
            ("Space", lambda robot: robot.cockpit.state.stopped),
        ):
            page.keyboard.press(key)
            wait_until(lambda acted=acted, mine=mine: acted(mine), f"what {key} does", page)
            assert not acted(other)
        page.wait_for_function("sheathOperator.state.stopped")
        page.keyboard.press("r")
        wait_until(lambda mine=mine: not mine.cockpit.state.stopped, "reset", page)
        page.wait_for_function("!sheathOperator.state.stopped")
        for key in "th":
            page.keyboard.press(key)
        wait_until(lambda mine=mine: not mine.cockpit.state.taken, "hand-back", page)
        mine.cockpit.resume()
        page.close()


def test_what_opens_one_opens_no_other(first, second):
    token = first.page.address.rpartition("/")[2]
    assert not admission(f"http://127.0.0.1:{second.port}/{token}").cookie
    assert admission(first.page.address).path != admission(second.page.address).path


@dataclass
class Spy:
    """Somebody else's web server on this machine, and what it heard."""

    address: str
    heard: list[tuple[str, dict[str, str]]] = field(default_factory=list)
    """paths and headers"""
    found: dict[str, str] = field(default_factory=dict)
    """what its page came to"""


ATTACK = """<!doctype html><title>spy</title><script>
const port = %d, paths = ["/", "/keys", "/index.html"], found = {cookie: document.cookie};
const settle = (promise) => promise.then((value) => `reached ${value}`, () => "refused");
const knock = (path) => new Promise((reached, refused) => {
  const socket = new WebSocket(`ws://127.0.0.1:${port}${path}`);
  socket.onopen = () => {
    socket.send(JSON.stringify({order: "emergency-stop"}));
    reached("socket");
  };
  socket.onerror = refused;
});
const load = (path) => new Promise((reached, refused) => {
  const element = document.createElement("script");
  element.onload = reached;
  element.onerror = refused;
  element.src = `http://127.0.0.1:${port}${path}`;
  (document.body ?? document.documentElement).append(element);
});
onload = async () => {
  for (const path of paths) {
    const url = `http://127.0.0.1:${port}${path}`;
    const ask = (method) => fetch(url, {method, credentials: "include"}).then((it) => it.text());
    found[`get ${path}`] = await settle(ask("GET"));
    found[`post ${path}`] = await settle(ask("POST"));
    found[`socket ${path}`] = await settle(knock(path));
    found[`script ${path}`] = await settle(load(path));
  }
  // And have the browser say its cookies to every path that the spy can think of.
  for (const path of [...paths, "/sheath", "/sheath/"]) await fetch(path, {credentials: "include"});
  await fetch("/found", {method: "POST", body: JSON.stringify(found)});
};
</script>"""


@contextmanager
def spying_on(port: int, at: int) -> Iterator[Spy]:
    spy = Spy(f"http://127.0.0.1:{at}/")

    class Answers(BaseHTTPRequestHandler):
        def log_message(self, format: str, *args: object) -> None:
            """Say nothing on the terminal."""

        def do_GET(self) -> None:
            spy.heard.append((self.path, dict(self.headers)))
            self._say(ATTACK % port)

        def do_POST(self) -> None:
            spy.heard.append((self.path, dict(self.headers)))
            spy.found = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
            self._say("")

        def _say(self, text: str) -> None:
            self.send_response(200)
            self.send_header("Content-Type", "text/html")
            self.send_header("Content-Length", str(len(text.encode())))
            self.end_headers()
            self.wfile.write(text.encode())

    with ThreadingHTTPServer(("127.0.0.1", at), Answers) as server:
        thread = threading.Thread(target=server.serve_forever, daemon=True)
        thread.start()
        try:
            yield spy
        finally:
            server.shutdown()
            thread.join(DEADLINE_S)


def test_a_server_on_another_port_gets_nothing_that_lets_it_in(first, contexts):
    page = opened(contexts[0], first)
    state = first.cockpit.state
    secrets = (first.page._server.access.path, first.page._server.access.cookie)
    with spying_on(first.port, free_neighbour(first.port + 1)) as spy:
        # By a link on the page itself, which would carry the page's address as its referrer.
        page.evaluate("url => { location.href = url; }", spy.address)
        wait_until(lambda: bool(spy.found), "what the spy found", page)
        page.close()
    assert len(spy.heard) >= 6
    said = json.dumps(spy.heard)
    assert not any(secret in said for secret in secrets)
    assert not any("Cookie" in headers for _, headers in spy.heard)
    # Nor where it came from.
    assert f":{first.port}" not in said
    assert spy.found.pop("cookie") == ""
    assert len(spy.found) == 12
    assert set(spy.found.values()) == {"refused"}
    assert first.cockpit.state == state
