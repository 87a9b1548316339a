"""A websocket of the page's own by which a person moves in time: clicks on strips and plots, keys.

viser's texts and plots tell of no click. The page's script (`seek.js`) does, and every page that
has the cookie may: to look at another step changes nothing of a run.
"""

import json
import time
from pathlib import Path
from typing import Annotated, Protocol

import msgspec
from msgspec import Meta
from websockets.asyncio.server import ServerConnection
from websockets.exceptions import ConnectionClosed

from sheath_manip.dashboard.message_age import Budget
from sheath_manip.dataset.fields import MOST_STEPS
from sheath_manip.dataset.marks import LONGEST_NOTE

PATH = "/seek"
"""below the page's own"""
SCRIPT = Path(__file__).with_name("seek.js")
LONGEST_MESSAGE = 2048
_Step = Annotated[int, Meta(ge=-MOST_STEPS, le=MOST_STEPS)]


class Seeks(Protocol):
    """What a page moves in time; each call returns at once."""

    def look_at(self, step: int) -> None:
        """Show that step, clamped to those there are."""
        ...

    def nudge(self, steps: int) -> None:
        """Go so many steps on, or back."""
        ...

    def press(self, name: str) -> None:
        """Do what a key says: `toggle`, `stop`, `backwards`, `forwards`, `before` or `after`."""
        ...

    def load(self, place: int, step: int | None) -> None:
        """Show the episode at that place, and stand at that step of it; there may be none."""
        ...

    def note(self, text: str) -> None:
        """Keep a note of the step that is shown."""
        ...


class SeekMessage(msgspec.Struct, forbid_unknown_fields=True, frozen=True):
    """One message of a page."""

    step: _Step | None = None
    nudge: _Step | None = None
    key: Annotated[str, Meta(max_length=20)] | None = None
    episode: Annotated[int, Meta(ge=0, le=MOST_STEPS)] | None = None
    note: Annotated[str, Meta(max_length=LONGEST_NOTE)] | None = None


_decode = msgspec.json.Decoder(SeekMessage).decode


class SeekSocket:
    """Serves every page; what a page says before there is something to move is not heard."""

    def __init__(self, has_keys: bool = False) -> None:
        self.target: Seeks | None = None
        self._has_keys = has_keys

    def script(self) -> str:
        """Return the JavaScript for viser's page."""
        settings = {"path": PATH, "keys": self._has_keys, "longest": LONGEST_NOTE}
        return f"({SCRIPT.read_text()})({json.dumps(settings)})"

    async def serve(self, connection: ServerConnection) -> None:
        """Serve one page until it goes."""
        budget = Budget()
        try:
            async for raw in connection:
                said = _said(raw)
                heard = not budget.exceeded(time.monotonic())
                if said is not None and heard and self.target is not None:
                    _follow(self.target, said)
        except ConnectionClosed:
            pass


def _said(raw: str | bytes) -> SeekMessage | None:
    if not isinstance(raw, str) or len(raw) > LONGEST_MESSAGE:
        return None
    try:
        return _decode(raw)
    except (msgspec.DecodeError, UnicodeEncodeError, RecursionError):
        return None


def _follow(target: Seeks, said: SeekMessage) -> None:
    if said.episode is not None:
        target.load(said.episode, said.step)
    elif said.step is not None:
        target.look_at(said.step)
    if said.nudge is not None:
        target.nudge(said.nudge)
    if said.key is not None:
        target.press(said.key)
    if said.note is not None:
        target.note(said.note)
