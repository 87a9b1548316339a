"""The headers that each answer of the page's server carries, whatever it answers."""

from websockets.datastructures import Headers

_SOURCES = {
    "default-src": "'none'",
    # viser's client unpacks itself into an inline script, builds its workers from blobs and runs
    # the page's own script by name; attributes of elements (onerror=...) are never a script.
    "script-src": "'self' 'unsafe-inline' 'unsafe-eval' blob:",
    "script-src-attr": "'none'",
    "worker-src": "blob: data:",
    "style-src": "'unsafe-inline'",
    "img-src": "'self' data: blob:",
    "font-src": "data:",
    "media-src": "data: blob:",
    "base-uri": "'none'",
    "form-action": "'none'",
    "frame-ancestors": "'none'",
}
_OTHERS = {
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Cache-Control": "no-store",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
}


def harden(headers: Headers, host: str | None) -> None:
    """Put into `headers` what tells a browser to load nothing from elsewhere, and to keep nothing.

    `host` is how the page was called, None where it was called by no name of its own.
    """
    # Older browsers do not take a websocket for one's own.
    sockets = "" if host is None else f" ws://{host} wss://{host}"
    sources = _SOURCES | {"connect-src": f"'self' data: blob:{sockets}"}
    policy = "; ".join(f"{kind} {where}" for kind, where in sources.items())
    for name, value in {"Content-Security-Policy": policy, **_OTHERS}.items():
        if name in headers:
            del headers[name]
        headers[name] = value
