"""A browser's place at a page, without the browser: it takes all that the page sends, or stalls.

    python -m tools.page_client ADDRESS [--stalled]

In a process of its own, so that it takes no time of the one that is measured.
"""

import argparse
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import msgspec
import viser
from websockets.exceptions import ConnectionClosed
from websockets.typing import Subprotocol

from tools.station import TIMEOUT_S, open_socket

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
"""with which a browser introduces itself: before it viser counts nobody in"""
SUBPROTOCOL = Subprotocol(f"viser-v{viser.__version__}")
READY = "ready"
STALLED_S, AWAKE_S = 15.0, 0.5
"""so that it just escapes being taken for dead: after 20 s of silence the server lets go of it"""


@contextmanager
def page_clients(address: str, readers: int, stalled: int) -> Iterator[None]:
    """So many of each kind at the page, until the block ends."""
    kinds = [()] * readers + [("--stalled",)] * stalled
    processes = [
        subprocess.Popen(
            (sys.executable, "-m", "tools.page_client", address, *kind),
            stdout=subprocess.PIPE,
            text=True,
        )
        for kind in kinds
    ]
    try:
        for process in processes:
            assert process.stdout is not None
            if process.stdout.readline().strip() != READY:
                raise RuntimeError("a client did not reach the page")
        yield
    finally:
        for process in processes:
            process.kill()
            process.wait(TIMEOUT_S)
            if process.stdout is not None:
                process.stdout.close()


def main(arguments: Sequence[str] | None = None) -> int:
    """Run from the command line, until it is killed or the page is gone."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("address", help="as the run printed it")
    parser.add_argument("--stalled", action="store_true", help="hardly ever read")
    options = parser.parse_args(arguments)
    with open_socket(
        options.address, "/", subprotocols=[SUBPROTOCOL], max_size=None, max_queue=1
    ) as socket:
        socket.send(msgspec.msgpack.encode(CAMERA))
        print(READY, flush=True)
        awake_until_s = 0.0
        try:
            while True:
                socket.recv()
                if options.stalled and time.monotonic() > awake_until_s:
                    time.sleep(STALLED_S)
                    awake_until_s = time.monotonic() + AWAKE_S
        except ConnectionClosed:
            return 0


if __name__ == "__main__":
    sys.exit(main())
