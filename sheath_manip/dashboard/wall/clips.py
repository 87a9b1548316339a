"""Clips that pages have asked for: made one after the other, kept until others have been made."""

import threading
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass

from sheath_manip.dashboard.player import Player
from sheath_manip.exceptions import SheathError

Clipping = Callable[[int, int, int, str], tuple[str, bytes]]
"""from the place of an episode, the first step, the one after the last, and `mp4` or `gif`: the
name of the file, and its content; called on the player's thread"""
MOST_KEPT, MOST_WAITING = 4, 4


@dataclass(frozen=True)
class Asked:
    """A clip that is asked for."""

    place: int
    first: int
    stop: int
    kind: str


@dataclass(frozen=True)
class Made:
    """A clip that is there, or why there is none."""

    name: str = ""
    content: bytes = b""
    failure: str = ""


class Clips:
    """Asked by any thread; the environment is the player's, so that it does the work."""

    def __init__(self, clipping: Clipping, player: Player) -> None:
        self._clipping, self._player = clipping, player
        self._lock = threading.Lock()
        self._waiting = set[Asked]()
        self._made = OrderedDict[Asked, Made]()

    def ask(self, asked: Asked) -> Made | None:
        """Return the clip; None while it is made, which begins with the first call."""
        with self._lock:
            made = self._made.get(asked)
            if made is not None:
                if made.failure:
                    # Told once; who asks again has it tried again.
                    del self._made[asked]
                return made
            if asked in self._waiting:
                return None
            if len(self._waiting) >= MOST_WAITING:
                return Made(failure=f"{MOST_WAITING} clips are being made; wait for one of them")
            self._waiting.add(asked)
        self._player.do(lambda: self._make(asked), f"making the {asked.kind} …")
        return None

    def _make(self, asked: Asked) -> None:
        try:
            made = Made(*self._clipping(asked.place, asked.first, asked.stop, asked.kind))
        except SheathError as error:
            made = Made(failure=str(error))
        except Exception as error:
            made = Made(failure=f"{type(error).__name__}: {error}")
        with self._lock:
            self._waiting.discard(asked)
            self._made[asked] = made
            while len(self._made) > MOST_KEPT:
                self._made.popitem(last=False)
        self._player.say(made.failure or f"{made.name}: {len(made.content) / 1e6:.1f} MB")
