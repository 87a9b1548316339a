"""What the bench tools share: a measured number with its goal, and the file that they write."""

import argparse
import json
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TypeVar

import numpy as np

from sheath_manip.rollout.threads import single_threaded

Sizes = TypeVar("Sizes")
Clock = Callable[[], float]
"""seconds since some moment"""


@dataclass(frozen=True)
class Line:
    """One measured number and what it is to be."""

    value: float
    unit: str
    goal: str
    holds: bool
    how: str


def at_least(value: float, bound: float, unit: str, how: str) -> Line:
    """A line whose goal is a least value."""
    return Line(float(value), unit, f">= {bound:g}", bool(value >= bound), how)


def at_most(value: float, bound: float, unit: str, how: str) -> Line:
    """A line whose goal is a greatest value."""
    return Line(float(value), unit, f"<= {bound:g}", bool(value <= bound), how)


def spent_s(call: Callable[[], object], calls: int = 1, clock: Clock = time.process_time) -> float:
    """CPU seconds of a call, the mean of `calls` of them; or those of another clock."""
    start = clock()
    for _ in range(calls):
        call()
    return (clock() - start) / calls


def medians(
    theirs: Callable[[], object],
    ours: Callable[[], object],
    rounds: int,
    calls: int = 1,
    clock: Clock = time.process_time,
) -> list[float]:
    """The median CPU seconds of a call of each side, which take turns; or another clock's."""
    times = [[spent_s(side, calls, clock) for side in (theirs, ours)] for _ in range(rounds)]
    return np.median(times, axis=0).tolist()


def run_bench(
    name: str,
    description: str | None,
    measures: Sequence[Callable[[Sizes], dict[str, Line]]],
    full: Sizes,
    quick: Sizes,
    arguments: Sequence[str] | None,
) -> None:
    """Measure, print a line a number, write bench-`name`.json."""
    parser = argparse.ArgumentParser(
        description=description, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--quick", action="store_true", help="other sizes, a few seconds")
    parser.add_argument(
        "--results", type=Path, default=Path("results"), help="directory to write to"
    )
    options = parser.parse_args(arguments)
    found: dict[str, Line] = {}
    for measure in measures:
        with single_threaded():
            lines = measure(quick if options.quick else full)
        for title, line in lines.items():
            mark = "yes" if line.holds else "NO"
            print(
                f"{title:40} {line.value:8.4g} {line.unit:26} {line.goal:9} {mark:3} {line.how}",
                flush=True,
            )
        found |= lines
    options.results.mkdir(parents=True, exist_ok=True)
    text = json.dumps({title: asdict(line) for title, line in found.items()}, indent=2)
    (options.results / f"bench-{name}.json").write_text(text + "\n")
