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
import os
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from types import TracebackType
from typing import Self

import numpy as np

from tools.bench import Line, at_least

HERE = Path(__file__).resolve().parents[1]
SIDES = HERE / "tools" / "sides"
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


class Side:
    """A process that refits whenever it is told to; a checkout's own code runs in it."""

    def __init__(self, checkout: Path, script: str, task: str, sizes: Sizes) -> None:
        environment = os.environ | {
            "PYTHONPATH": str(checkout),
            "OMP_NUM_THREADS": "1",
            "MKL_NUM_THREADS": "1",
        }
        counts = (sizes.demonstrations, sizes.held_out, sizes.check, sizes.visited)
        self._process = subprocess.Popen(
            [sys.executable, str(SIDES / script), task, *map(str, counts)],
            env=environment,
            cwd=checkout,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        # Ready once its episodes are recorded and its policy is fitted.
        self.states = int(self._answer())

    def refit_s(self) -> float:
        """CPU seconds of one refit."""
        assert self._process.stdin is not None
        self._process.stdin.write("refit\n")
        self._process.stdin.flush()
        return float(self._answer())

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._process.kill()
        self._process.wait()

    def _answer(self) -> str:
        assert self._process.stdout is not None
        line = self._process.stdout.readline()
        if not line:
            raise SystemExit(f"{self._process.args} ended; wanted a figure from it")
        return line


def refits(before: Path, task: str, goal: float, sizes: Sizes) -> Line:
    """The ratio of the medians of both sides' refits."""
    with (
        Side(before, "refit_before.py", task, sizes) as theirs,
        Side(HERE, "refit_now.py", task, sizes) as ours,
    ):
        times = [(theirs.refit_s(), ours.refit_s()) for _ in range(sizes.turns)]
        then_s, now_s = np.median(times, axis=0)
        how = f"{then_s:.2f} s before, {now_s:.2f} s now, {ours.states} training states"
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
