"""How far a long piece of work is: loops deep inside it count, and who announced it is told.

Between the two lie policies, embeddings and supports that need know nothing of it.
"""

import threading
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TypeVar

from sheath_manip.types.work import Work

Item = TypeVar("Item")
Tell = Callable[[Work | None], None]
PARTS = 100
"""of a loop, after each of which word is given"""


@dataclass
class _Announced:
    what: str
    tell: Tell
    low: float = 0.0
    high: float = 1.0
    """the share within which a loop counts that runs now: the round of the loop around it"""


class _OfThread(threading.local):
    announced: _Announced | None = None


_now = _OfThread()


@contextmanager
def announced(what: str, tell: Tell) -> Iterator[None]:
    """Tell that `what` is done on this thread, how far it is, and with None that it is over.

    `tell` returns at once.
    """
    before = _now.announced
    _now.announced = _Announced(what, tell)
    tell(Work(what))
    try:
        yield
    finally:
        _now.announced = before
        tell(None)


def counted(items: Iterable[Item], length: int) -> Iterator[Item]:
    """All `length` `items`; a loop in a round of a loop counts within that round's share."""
    outer = _now.announced
    if outer is None or length < 1:
        yield from items
        return
    low, high = outer.low, outer.high
    every = max(1, length // PARTS)
    try:
        for number, item in enumerate(items):
            outer.low, outer.high = (
                low + (high - low) * each / length for each in (number, number + 1)
            )
            if number % every == 0:
                outer.tell(Work(outer.what, outer.low))
            yield item
    finally:
        outer.low, outer.high = low, high
