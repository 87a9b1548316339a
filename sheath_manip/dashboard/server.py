"""viser's server behind the access control: guarded from its first request on, and never shared."""

import asyncio
import contextlib
import secrets
import socket
import threading
from collections.abc import Awaitable, Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from http import HTTPStatus
from typing import Any, NoReturn, Protocol

import rich
import viser
import websockets.asyncio.server
from viser._messages import RunJavascriptMessage, ShareUrlDisconnect, ShareUrlRequest
from websockets.asyncio.server import ServerConnection
from websockets.http11 import Request, Response

from sheath_manip.cockpit import Cockpit
from sheath_manip.dashboard import (
    headers,
    operator_socket,
    pictures_socket,
    seek_socket,
    server_log,
)
from sheath_manip.dashboard.access import AccessControl
from sheath_manip.dashboard.inspection import InspectedConnection, Inspection
from sheath_manip.dashboard.operator_socket import Looks, OperatorSocket, station_of
from sheath_manip.dashboard.paced_connection import PacedConnection
from sheath_manip.dashboard.page_script import chart_script
from sheath_manip.dashboard.pictures_socket import PicturesSocket
from sheath_manip.dashboard.seek_socket import SeekSocket
from sheath_manip.dashboard.wall import pages
from sheath_manip.dashboard.wall.pages import WallPages
from sheath_manip.exceptions import ParameterError, SetupError

MIN_TOKEN_LENGTH = 8
LONGEST_MESSAGE = 2**16
"""bytes that a browser may send at once; viser's own limit is 50 MB"""
FAREWELL_S = 0.5
"""for the pages to hear that the run has ended"""
SUBPROTOCOL = f"viser-v{viser.__version__}"
"""of viser's client; to any other viser would answer on the terminal, in that one's own words"""

SOCKETS = ("/", operator_socket.PATH, seek_socket.PATH, pictures_socket.PATH)
"""where there is a websocket"""

_serve_is_wrapped = threading.Lock()


class OwnSocket(Protocol):
    """A websocket of the page's own."""

    async def serve(self, connection: ServerConnection) -> None:
        """Serve one page, until its connection ends."""
        ...


@dataclass(frozen=True, eq=False)
class GuardedServer:
    """A running viser server behind its access control."""

    viser: viser.ViserServer
    access: AccessControl
    operators: OperatorSocket
    loop: asyncio.AbstractEventLoop
    """of all connections, in a thread of viser's"""

    @classmethod
    def open(
        cls,
        host: str,
        port: int,
        token: str | None,
        label: str,
        cockpit: Cockpit,
        true_s: Callable[[], float] | None = None,
        seeking: SeekSocket | None = None,
        wall: WallPages | None = None,
        pictures: PicturesSocket | None = None,
    ) -> "GuardedServer":
        """Listen on `host` and `port` (0: any free one) and build the server on top.

        Each page gets the script by which a person operates `cockpit`. `true_s` is up to when what
        was drawn is true (`time.monotonic`): who drives by what is too old is not heard. None is
        for pages that show nothing of the present. By `seeking` a page moves in time, `wall` is
        what recorded moments are chosen from, and `pictures` are what each of several robots sees.

        Raises:
            SetupError: the port is taken, or the host is not one of this machine.
            ParameterError: a token that is too short to keep anybody out.
        """
        if token is not None and len(token) < MIN_TOKEN_LENGTH:
            raise ParameterError(
                f"the dashboard's token has {len(token)} characters; wanted at least "
                f"{MIN_TOKEN_LENGTH}, or None for a random one"
            )
        listener = _listen(host, port)
        access = AccessControl(host, listener.getsockname()[1], token or secrets.token_urlsafe(24))
        inspection, operators = Inspection(), OperatorSocket(cockpit, label)
        seeking = seeking or SeekSocket()
        own: dict[str, OwnSocket] = {
            operator_socket.PATH: operators,
            seek_socket.PATH: seeking,
            pictures_socket.PATH: pictures or PicturesSocket(),
        }
        try:
            with _wrapped_serve(access, listener, inspection, own, wall), _quiet():
                server = viser.ViserServer(host=host, port=access.port, label=label, verbose=False)
        except BaseException:
            listener.close()
            raise
        inspection.bind(server)
        loop = server._websock_server._background_event_loop
        assert loop is not None
        server_log.quieten(loop)
        scripts = [seeking.script, chart_script, *([wall.script] if wall else [])]
        _give_script(server, operators, true_s, scripts)
        server.request_share_url = _refuse_share
        for message in (ShareUrlRequest, ShareUrlDisconnect):
            server._websock_server.unregister_handler(message)
        server.gui.configure_theme(**_theme(Looks()))
        server.gui.main_panel.dock_right()
        return cls(server, access, operators, loop)

    def close(self, saved_in: str = "") -> None:
        """Say that this is the end, and where it is `saved_in`; end every connection."""
        self.say_finished(saved_in)
        with _quiet():
            self.viser.stop()

    def say_finished(self, saved_in: str) -> None:
        """Tell the pages, also those that are opened later; wait for it, but not for long."""
        with contextlib.suppress(Exception):
            saying = asyncio.run_coroutine_threadsafe(
                self.operators.say_finished(saved_in), self.loop
            )
            saying.result(FAREWELL_S)


def _listen(host: str, port: int) -> socket.socket:
    # The socket is bound here and handed to viser, which on its own would take the next free port
    # without a word, or wait for ever on a host that cannot be bound.
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    try:
        return socket.create_server((host, port), family=family)
    except (OSError, OverflowError) as error:
        raise SetupError(
            f"the dashboard cannot listen on {host}:{port} ({error}); "
            "choose another one, such as --port 0 for any that is free"
        ) from error


@contextlib.contextmanager
def _wrapped_serve(
    access: AccessControl,
    listener: socket.socket,
    inspection: Inspection,
    own: Mapping[str, OwnSocket],
    wall: WallPages | None,
) -> Iterator[None]:
    """While viser starts, put the guards in front of the one server that it opens, on `listener`.

    `access` says who comes in, `inspection` what viser hears of those, and `own` serves the page's
    own websockets beside viser's, by their path; `wall` gives files.
    """
    serve: Any = websockets.asyncio.server.serve
    used = False

    def guarded_serve(
        handler: Any, _host: Any, _port: Any, *, process_request: Any, **options: Any
    ) -> Any:
        nonlocal used
        used = True

        async def route(connection: ServerConnection) -> None:
            assert connection.request is not None
            if (ours := own.get(access.inside(connection.request))) is not None:
                await ours.serve(connection)
            elif connection.subprotocol == SUBPROTOCOL:
                paced = PacedConnection(InspectedConnection(connection, inspection))
                marking = asyncio.create_task(paced.keep_marking())
                try:
                    await handler(paced)
                finally:
                    marking.cancel()

        def check_first(connection: Any, request: Request) -> Response | Awaitable[Response] | None:
            refused = access.answer(request)
            if refused is not None:
                return refused
            below = Request(access.inside(request), request.headers)
            if "Upgrade" in request.headers and below.path not in SOCKETS:
                return connection.respond(HTTPStatus.NOT_FOUND, "Here is no websocket.")
            if wall is not None and below.path.startswith(pages.PATH):
                return wall.answer(below)
            return process_request(connection, below)

        def harden_last(_: Any, request: Request, response: Response) -> None:
            host = request.headers.get_all("Host")[:1]
            named = host[0] if host and access.admits(host[0].lower()) else None
            headers.harden(response.headers, named)

        options["max_size"] = LONGEST_MESSAGE
        return serve(
            route,
            sock=listener,
            process_request=check_first,
            process_response=harden_last,
            server_header=None,
            logger=server_log.kinds_only(),
            **options,
        )

    with _serve_is_wrapped:
        websockets.asyncio.server.serve = guarded_serve  # type: ignore[misc, assignment]
        try:
            yield
        finally:
            websockets.asyncio.server.serve = serve  # type: ignore[misc]
    if not used:
        raise SetupError(
            f"viser {viser.__version__} opened its server past the access control; wanted viser 1.1"
        )


@contextlib.contextmanager
def _quiet() -> Iterator[None]:
    """Keep viser from printing its address, which is refused without the token."""
    console = rich.get_console()
    before, console.quiet = console.quiet, True
    try:
        yield
    finally:
        console.quiet = before


def _refuse_share(verbose: bool = True) -> NoReturn:  # noqa: ARG001 - viser's signature
    raise SetupError(
        "the dashboard is never shared through a public tunnel; forward its port over ssh"
    )


def _theme(looks: Looks) -> Any:
    width = "medium" if looks.narrow else "large"
    shown: Any = {"show_share_button": False, "show_logo": False}
    return {**shown, "control_width": width, "dark_mode": looks.dark}


def _give_script(
    server: viser.ViserServer,
    operators: OperatorSocket,
    true_s: Callable[[], float] | None,
    scripts: Sequence[Callable[[], str]],
) -> None:
    sockets, buffer = server._websock_server, server._websock_server.get_message_buffer()

    @server.on_client_connect
    async def _(client: viser.ClientHandle) -> None:
        page = client.client_id

        def run(source: str) -> None:
            # A browser may go at any moment, and viser would say so on the terminal.
            with client._websock_connection.get_message_buffer().sanctioned_dead_writes():
                client._websock_connection.queue_message(RunJavascriptMessage(source))

        def taken_s() -> float | None:
            waiting = buffer.message_counter - 1 > buffer.generator_cursors.get(page, -1)
            return None if waiting or true_s is None else true_s()

        run(operators.script(page))
        for script in scripts:
            run(script())
        connection: Any = sockets._live_connections.get(page)
        if connection is not None and true_s is not None:
            mark = "window.sheathOperator?.saw({})".format
            age = operators.follow_picture(page)
            connection.carry_marks(age, taken_s, lambda number: run(mark(number)))

    def look(station: str, looks: Looks) -> None:
        for client in server.get_clients().values():
            if station_of(client.client_id) == station:
                client.gui.configure_theme(**_theme(looks))

    operators.on_looks = look

    @server.on_client_disconnect
    async def _(client: viser.ClientHandle) -> None:
        operators.forget(client.client_id)
