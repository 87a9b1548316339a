"""A person's place at the page, as a process that one may kill: it takes over and holds a key.

    python doomed_station.py PORT PATH COOKIE KEY

It imports nothing of the project, so that it is there at once.
"""

import base64
import json
import os
import socket
import sys
import time

port, path, cookie, key = sys.argv[1:]


def frame(message: dict) -> bytes:
    """As a client sends it, masked by nothing; of at most 125 bytes."""
    payload = json.dumps(message).encode()
    return bytes((0x81, 0x80 | len(payload), 0, 0, 0, 0)) + payload


with socket.create_connection(("127.0.0.1", int(port))) as connection:
    lines = (
        f"GET {path} HTTP/1.1",
        f"Host: 127.0.0.1:{port}",
        f"Cookie: {cookie}",
        "Connection: Upgrade",
        "Upgrade: websocket",
        "Sec-WebSocket-Version: 13",
        f"Sec-WebSocket-Key: {base64.b64encode(os.urandom(16)).decode()}",
    )
    connection.sendall("\r\n".join((*lines, "", "")).encode())
    assert connection.recv(4096).startswith(b"HTTP/1.1 101")
    connection.sendall(frame({"order": "take-over"}))
    while True:
        connection.sendall(frame({"keys": [key], "clock": time.monotonic() * 1000}))
        time.sleep(0.05)
