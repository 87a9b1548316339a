"""A wall of moments that is open, without the browser: a replay's server, and who reads of it.

    python -m tools.wall_reader [--episodes 10000]

In a process of its own, as `sheath replay` is. It says `ready` once it has found all moments; then
it asks for what an open wall asks for, each time that a line comes, and for the whole list of
moments every tenth time.
"""

import argparse
import http.client
import subprocess
import sys
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from urllib.parse import urlsplit

from sheath_manip.protocols import Listener
from sheath_manip.types import Step
from tools.bench_wall import nothing_to_see
from tools.page_client import READY
from tools.station import TIMEOUT_S, admission
from tools.synthetic_store import SyntheticStore

LIST_EVERY = 10


class BesideWall:
    """A page that follows, and a wall beside it that is looked at in each step."""

    def __init__(self, page: Listener, wall: "subprocess.Popen[str]") -> None:
        self._page, self._wall = page, wall

    def on_fit(self, states) -> None:
        """As the page."""
        self._page.on_fit(states)

    def on_start(self, environment, info) -> None:
        """As the page."""
        self._page.on_start(environment, info)

    def on_step(self, environment, step: Step) -> None:
        """As the page; the wall hears of it."""
        self._page.on_step(environment, step)
        assert self._wall.stdin is not None
        self._wall.stdin.write("\n")
        self._wall.stdin.flush()

    def on_end(self, episode) -> None:
        """As the page."""
        self._page.on_end(episode)


@contextmanager
def open_wall(episodes: int) -> Iterator["subprocess.Popen[str]"]:
    """The process, until the block ends."""
    command = (sys.executable, "-m", "tools.wall_reader", "--episodes", str(episodes))
    pipe = subprocess.PIPE
    with subprocess.Popen(command, stdin=pipe, stdout=pipe, text=True) as process:
        try:
            assert process.stdout is not None
            if process.stdout.readline().strip() != READY:
                raise RuntimeError("the wall did not open")
            yield process
        finally:
            process.kill()
            process.wait(TIMEOUT_S)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run from the command line, until nothing more is asked for."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--episodes", type=int, default=10_000)
    options = parser.parse_args(arguments)
    with nothing_to_see(SyntheticStore(options.episodes)) as replay:
        threading.Thread(target=replay.run, args=(0,), daemon=True).start()
        while replay._wall._shelf._read < options.episodes:
            time.sleep(0.05)
        admitted, where = admission(replay.address), urlsplit(replay.address)
        connection = http.client.HTTPConnection(str(where.hostname), where.port, timeout=TIMEOUT_S)
        print(READY, flush=True)
        for number, _ in enumerate(sys.stdin):
            wanted = "now" if number % LIST_EVERY else "moments"
            path = f"{admitted.path}/wall/{wanted}"
            connection.request("GET", path, headers={"Cookie": admitted.cookie})
            answer = connection.getresponse()
            if answer.status != http.client.OK:
                raise RuntimeError(f"the wall answered {answer.status}")
            answer.read()
    return 0


if __name__ == "__main__":
    sys.exit(main())
