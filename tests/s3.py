"""A server of the S3 protocol on the loopback interface, for tests of object stores."""

import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from http.client import HTTPConnection

from moto.server import ThreadedMotoServer

BUCKET = "demonstrations"


@contextmanager
def s3_server() -> Iterator[None]:
    """Serve one empty bucket, and let the environment point there."""
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    before = dict(os.environ)
    server = ThreadedMotoServer("127.0.0.1", port, verbose=False)
    server.start()
    try:
        request = HTTPConnection("127.0.0.1", port)
        request.request("PUT", f"/{BUCKET}")
        request.getresponse().read()
        request.close()
        os.environ |= {
            "AWS_ENDPOINT_URL": f"http://127.0.0.1:{port}",
            "AWS_ALLOW_HTTP": "true",
            "AWS_ACCESS_KEY_ID": "nobody",
            "AWS_SECRET_ACCESS_KEY": "nothing",
            "AWS_REGION": "us-east-1",
        }
        yield
    finally:
        os.environ.clear()
        os.environ.update(before)
        server.stop()
