"""What the wall's script asks the server for, below the path that nobody can guess: plain files.

Whatever is asked for is one of a few written-out paths of numbers. Work is done beside the event
loop, on one thread for lists and one for pictures, so that the page's sockets go on.
"""

import asyncio
import json
import re
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from http import HTTPStatus
from pathlib import Path

from websockets.datastructures import Headers
from websockets.http11 import Request, Response

from sheath_manip.dashboard.catalog import EpisodeCatalog
from sheath_manip.dashboard.page_script import bundled
from sheath_manip.dashboard.player import Player
from sheath_manip.dashboard.wall import thumbnails
from sheath_manip.dashboard.wall.clips import Asked, Clipping, Clips
from sheath_manip.dashboard.wall.ranking import KINDS, Kind
from sheath_manip.dashboard.wall.shelf import Shelf
from sheath_manip.exceptions import SheathError
from sheath_manip.playback import clip, palette
from sheath_manip.types import Outcome

PATH = "/wall/"
"""below the page's own"""
_FOLDER = Path(__file__).parent
_PARTS = ("filters", "grid", "clipping", "wall")
_STRIP = re.compile(r"strip/([0-9]{1,9})/([0-9]{1,9})")
_CLIP = re.compile(r"clip/([0-9]{1,9})/([0-9]{1,9})/([0-9]{1,9})/(mp4|gif)")
_KIND_COLOURS = {
    Kind.FAILURE: palette.OUTCOME[Outcome.FAILURE],
    Kind.STUCK: palette.OUTCOME[Outcome.TIME_LIMIT],
    Kind.CUT_SHORT: palette.OUTCOME[Outcome.ERROR],
    Kind.IN_VAIN: (150, 60, 130),
    Kind.TAKEOVER: (213, 94, 0),
    Kind.NEAR_MISS: (230, 170, 30),
    Kind.MARK: (0, 114, 178),
}
_TYPES = {"mp4": "video/mp4", "gif": "image/gif"}


class WallPages:
    """Serves the wall of one replay page."""

    def __init__(self, catalog: EpisodeCatalog, player: Player, clipping: Clipping) -> None:
        self._catalog, self._player = catalog, player
        self._shelf = Shelf(catalog)
        self._thumbnails = thumbnails.Thumbnails(catalog)
        self._clips = Clips(clipping, player)
        self._lists = ThreadPoolExecutor(1, "wall lists")
        self._pictures = ThreadPoolExecutor(1, "wall pictures")

    def script(self) -> str:
        """Return the JavaScript for viser's page."""
        settings = {
            "path": PATH,
            "colours": [palette.css(_KIND_COLOURS[kind]) for kind in KINDS],
            "frames": thumbnails.FRAMES,
            "middle": thumbnails.MIDDLE,
            "longestClip": clip.MOST_STEPS,
            "style": (_FOLDER / "wall.css").read_text(),
        }
        return bundled(_FOLDER, _PARTS, settings)

    def close(self) -> None:
        """End the threads."""
        self._shelf.close()
        for pool in (self._lists, self._pictures):
            pool.shutdown(cancel_futures=True)

    async def answer(self, request: Request) -> Response:
        """Return the answer to a request for a path that begins with `PATH`."""
        wanted = request.path.removeprefix(PATH)
        if wanted == "moments":
            return await self._beside(self._lists, self._moments)
        if wanted == "now":
            return _response(HTTPStatus.OK, json.dumps(self._now()).encode(), "application/json")
        if strip := _STRIP.fullmatch(wanted):
            place, step = map(int, strip.groups())
            return await self._beside(self._pictures, partial(self._strip, place, step))
        if asked := _CLIP.fullmatch(wanted):
            place, first, stop = map(int, asked.groups()[:3])
            return self._clip(Asked(place, first, stop, asked[4]))
        return _line(HTTPStatus.NOT_FOUND, "There is nothing here.")

    async def _beside(self, pool: ThreadPoolExecutor, work: Callable[[], Response]) -> Response:
        try:
            working = asyncio.get_running_loop().run_in_executor(pool, work)
        except RuntimeError:
            return _line(HTTPStatus.SERVICE_UNAVAILABLE, "The page is being closed.")
        try:
            return await working
        except SheathError as error:
            return _line(HTTPStatus.NOT_FOUND, str(error))

    def _moments(self) -> Response:
        # Every browser that can run the page can unzip.
        zipped = {"Content-Encoding": "gzip"}
        return _response(HTTPStatus.OK, self._shelf.told(), "application/json", **zipped)

    def _strip(self, place: int, step: int) -> Response:
        strip = self._thumbnails.strip(place, step)
        if not strip:
            return _line(HTTPStatus.NOT_FOUND, "No camera has seen this episode.")
        return _response(HTTPStatus.OK, strip, "image/jpeg")

    def _now(self) -> dict[str, int | float]:
        now = self._player.now
        summary = self._catalog.summary(now.place)
        rate_hz = summary.info.control_rate_hz
        return {"place": now.place, "step": now.at, "steps": summary.length, "rate_hz": rate_hz}

    def _clip(self, asked: Asked) -> Response:
        try:
            steps = self._catalog.summary(asked.place).length
        except SheathError as error:
            return _line(HTTPStatus.NOT_FOUND, str(error))
        first = min(asked.first, steps - 1)
        stop = min(max(asked.stop, first + 1), steps, first + clip.MOST_STEPS)
        made = self._clips.ask(Asked(asked.place, first, stop, asked.kind))
        if made is None:
            return _line(HTTPStatus.ACCEPTED, "It is being made; ask again.")
        if made.failure:
            return _line(HTTPStatus.CONFLICT, made.failure)
        # The name of an episode is one of a file, quoted: letters, digits and signs of URLs.
        disposition = {"Content-Disposition": f'attachment; filename="{made.name}"'}
        return _response(HTTPStatus.OK, made.content, _TYPES[asked.kind], **disposition)


def _line(status: HTTPStatus, text: str) -> Response:
    return _response(status, text.encode(), "text/plain; charset=utf-8")


def _response(status: HTTPStatus, body: bytes, kind: str, **more: str) -> Response:
    fields = {"Content-Type": kind, "Content-Length": str(len(body)), "Connection": "close"}
    return Response(status.value, status.phrase, Headers(fields | more), body)
