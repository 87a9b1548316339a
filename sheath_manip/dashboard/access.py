"""Access control around viser's web server, which on its own obeys everybody who reaches it."""

import hmac
import ipaddress
import secrets
import socket
from dataclasses import dataclass, field
from http import HTTPStatus
from urllib.parse import parse_qs, quote

from websockets.datastructures import Headers
from websockets.http11 import Request, Response

WILDCARDS = ("", "0.0.0.0", "::")
COOKIE = "sheath"


@dataclass(frozen=True)
class AccessControl:
    """Decides about each request, page or websocket, before viser sees it.

    The page lies below a path that nobody can guess, and so does its cookie: a browser sends the
    cookies of a host to each of its ports, but only to the paths that they were given. Both are
    drawn anew for each server, whatever its token, and die with it.
    """

    host: str
    """the address that the server listens on"""
    port: int
    token: str = field(repr=False)
    path: str = field(default_factory=lambda: f"/{secrets.token_urlsafe(16)}", repr=False)
    """below which everything lies; without a slash at its end"""
    cookie: str = field(default_factory=lambda: secrets.token_urlsafe(24), repr=False)
    """the value of the browser's cookie"""

    @property
    def address(self) -> str:
        """The address at which a browser on this machine gets in, token included."""
        host = "127.0.0.1" if self.host in WILDCARDS else _bracketed(self.host)
        return f"http://{host}:{self.port}/?token={quote(self.token, safe='')}"

    def answer(self, request: Request) -> Response | None:
        """Return the response that ends `request` here, or None where it may go on to viser."""
        hosts = request.headers.get_all("Host")
        if len(hosts) != 1 or not self.admits(hosts[0].lower()):
            return _response(
                HTTPStatus.FORBIDDEN,
                f"This dashboard answers only to {', '.join(sorted(self._names))} on port "
                f"{self.port}; when forwarding it, keep the port number.",
            )
        own_origins = (f"http://{hosts[0]}", f"https://{hosts[0]}")
        if any(origin not in own_origins for origin in request.headers.get_all("Origin")):
            return _response(HTTPStatus.FORBIDDEN, "Pages of other sites may not use this one.")
        path, _, query = request.path.partition("?")
        if path == "/" and self._is_token(query):
            return self._welcome()
        if not self._has_cookie(request.headers):
            return _unauthorized()
        if _equal(path.rstrip("/"), self.path) and "?" in request.path:
            # Never passed on: viser's page would take even another server from it, and writes its
            # own there itself. Who loads that anew gets to the bare page.
            return _unauthorized() if "Upgrade" in request.headers else self._welcome()
        return None if self.inside(request) else _unauthorized()

    def inside(self, request: Request) -> str:
        """Return the path below the one that nobody can guess; empty for any other."""
        wanted = len(self.path)
        given, rest = request.path[:wanted], request.path[wanted:] or "/"
        return rest if _equal(given, self.path) and rest[0] == "/" and "?" not in rest else ""

    @property
    def _names(self) -> set[str]:
        names = {"127.0.0.1", "localhost"}
        return names | ({socket.gethostname()} if self.host in WILDCARDS else {self.host})

    def admits(self, host: str) -> bool:
        """Return whether the page may be called so, as a Host header says it in small letters."""
        name, _, port = host.rpartition(":") if not host.endswith("]") else (host, "", "80")
        if not name:
            name, port = host, "80"
        if port != str(self.port):
            return False
        if name.startswith("[") and name.endswith("]"):
            name = name[1:-1]
        # DNS rebinding needs a name that its attacker owns; a bare address is never one.
        return name in {known.lower() for known in self._names} or (
            self.host in WILDCARDS and _is_ip_address(name)
        )

    def _is_token(self, query: str) -> bool:
        given = parse_qs(query).get("token", [])
        return len(given) == 1 and _equal(given[0], self.token)

    def _has_cookie(self, headers: Headers) -> bool:
        pairs = (
            pair.strip().partition("=")
            for header in headers.get_all("Cookie")
            for pair in header.split(";")
        )
        return any(name == COOKIE and _equal(value, self.cookie) for name, _, value in pairs)

    def _welcome(self) -> Response:
        # A page of its own and not a redirect: a browser withholds a SameSite=Strict cookie on a
        # redirect that follows a link on another site. It also takes the token out of the history.
        page = (
            f'<!doctype html><title>sheath</title><script>location.replace("{self.path}")</script>'
        )
        cookie = f"{COOKIE}={self.cookie}; Path={self.path}; HttpOnly; SameSite=Strict"
        return _response(HTTPStatus.OK, page, **{"Set-Cookie": cookie})


def _unauthorized() -> Response:
    return _response(
        HTTPStatus.UNAUTHORIZED, "Open the address that the run printed, with its ?token=..."
    )


def _response(status: HTTPStatus, text: str, **headers: str) -> Response:
    body = text.encode()
    kind = "text/html" if text.startswith("<") else "text/plain"
    fields = {
        "Content-Type": f"{kind}; charset=utf-8",
        "Content-Length": str(len(body)),
        "Connection": "close",
    }
    return Response(status.value, status.phrase, Headers(fields | headers), body)


def _bracketed(host: str) -> str:
    return f"[{host}]" if ":" in host else host


def _equal(given: str, wanted: str) -> bool:
    return hmac.compare_digest(given.encode(errors="replace"), wanted.encode())


def _is_ip_address(name: str) -> bool:
    try:
        address = ipaddress.ip_address(name)
    except ValueError:
        return False
    # A zone names an interface of the one that asks: no browser says it, and it is free text.
    return getattr(address, "scope_id", None) is None
