"""How long pieces of work take on so many cores and devices: a simulated schedule."""

import heapq
from collections.abc import Sequence
from dataclasses import dataclass

from sheath_manip.exceptions import ParameterError
from sheath_manip.experiments.scale.work import Work

ORDER = {"fit": 0, "recorded": 1, "judging": 2}


@dataclass(frozen=True)
class Machines:
    """What works."""

    cores: int
    devices: int = 0
    """that fit, each one piece at a time; with none the cores do"""
    device_speedup: float = 10.0
    """how many times as fast a fit is there"""

    def __post_init__(self) -> None:
        if self.cores < 1 or self.devices < 0:
            raise ParameterError(
                f"cores is {self.cores} and devices {self.devices}; wanted at least 1 and 0"
            )


def wall_s(work: Sequence[Work], machines: Machines) -> float:
    """Return when all is done, where each free core takes the first piece that is ready.

    Fits go before episodes that are recorded, and these before those that only judge; each kind in
    the order in which they became ready, as the executors hand them out. A piece runs to its end.
    """
    waits = [len(piece.after) for piece in work]
    followers: list[list[int]] = [[] for _ in work]
    for place, piece in enumerate(work):
        for before in piece.after:
            followers[before].append(place)
    ready: dict[bool, list[tuple[int, int, int]]] = {True: [], False: []}
    free = {True: machines.devices, False: machines.cores}
    running: list[tuple[float, int, bool]] = []
    now_s, count = 0.0, 0

    def admit(place: int) -> None:
        nonlocal count
        count += 1
        fits = work[place].kind == "fit" and machines.devices > 0
        heapq.heappush(ready[fits], (ORDER[work[place].kind], count, place))

    for place, number in enumerate(waits):
        if number == 0:
            admit(place)
    while True:
        for on_device, waiting in ready.items():
            while waiting and free[on_device]:
                *_, place = heapq.heappop(waiting)
                free[on_device] -= 1
                took_s = work[place].cpu_s / (machines.device_speedup if on_device else 1.0)
                heapq.heappush(running, (now_s + took_s, place, on_device))
        if not running:
            return now_s
        now_s, place, on_device = heapq.heappop(running)
        free[on_device] += 1
        for follower in followers[place]:
            waits[follower] -= 1
            if waits[follower] == 0:
                admit(follower)


def longest_chain_s(work: Sequence[Work]) -> float:
    """Return the seconds of the longest chain of pieces, which no number of cores shortens."""
    ends: list[float] = []
    for piece in work:
        ends.append(piece.cpu_s + max((ends[before] for before in piece.after), default=0.0))
    return max(ends, default=0.0)
