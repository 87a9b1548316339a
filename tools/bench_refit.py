"""How much sooner a gate is refitted and measured now that each image is looked at once.

    python -m tools.bench_refit --before CHECKOUT [--quick] [--results DIRECTORY]

writes bench-refit.json, which `sheath claims` reads. CHECKOUT is a work tree of the version that is
held against, 6b34bec: what a round does once its policy is fitted, it does there by its own code,
on the same scenes and with a policy of the same seed. That is: fit the signal, calibrate it, find
the threshold, and measure epsilon, xi and the false alarms. Each side is a process of its own, and
they take turns; times are of their CPU on one thread, without their start.
"""

import argparse
import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from tools.bench import Line, at_least
from tools.side import HERE, Side

GOALS = {"driving": 2.2, "grasp-clutter": 2.2}
"""by task, how many times as fast a refit shall be"""


@dataclass(frozen=True)
class Sizes:
    """How much is measured."""

    demonstrations: int = 12
    held_out: int = 10
    check: int = 6
    visited: int = 6
    turns: int = 3


QUICK = Sizes(3, 3, 1, 1, 1)


def refits(before: Path, task: str, goal: float, sizes: Sizes) -> Line:
    """The ratio of the medians of both sides' refits."""
    counts = (sizes.demonstrations, sizes.held_out, sizes.check, sizes.visited)
    with (
        Side(before, "refit_before.py", task, *counts) as theirs,
        Side(HERE, "refit_now.py", task, *counts) as ours,
    ):
        times = [(theirs.measured(), ours.measured()) for _ in range(sizes.turns)]
        then_s, now_s = np.median(times, axis=0)
        how = f"{then_s:.2f} s before, {now_s:.2f} s now, {ours.first:.0f} training states"
        return at_least(then_s / now_s, goal, "times as fast", how)


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure, print a line a task, write bench-refit.json."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--before", type=Path, required=True, help="a work tree of 6b34bec")
    parser.add_argument("--quick", action="store_true", help="other sizes, to see that it runs")
    parser.add_argument("--results", type=Path, default=Path("results"), help="directory")
    options = parser.parse_args(arguments)
    sizes = QUICK if options.quick else Sizes()
    found: dict[str, Line] = {}
    for task, goal in GOALS.items():
        line = refits(options.before.resolve(), task, goal, sizes)
        found[f"refit of {task}"] = line
        print(
            f"refit of {task:16} {line.value:6.3g} {line.unit} {line.goal} {line.how}", flush=True
        )
    options.results.mkdir(parents=True, exist_ok=True)
    text = json.dumps({title: asdict(line) for title, line in found.items()}, indent=2)
    (options.results / "bench-refit.json").write_text(text + "\n")


if __name__ == "__main__":
    main()
