"""What it costs a control step that whatever fails in it is survived.

    python -m tools.bench_guard --before CHECKOUT [--quick] [--results DIRECTORY]

writes bench-guard.json, which `sheath claims` reads. CHECKOUT is a work tree of the version that is
held against, f473395. Each side is a process of its own, in which the expert's actions are proposed
by a policy that looks at every pixel and judged by a support gate; they run the same episodes and
take turns. Times are of their CPU on one thread, the median of the ratios of each turn.
"""

import argparse
import json
import os
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from types import TracebackType
from typing import Self

import numpy as np

from tools.bench import Line, at_most

HERE = Path(__file__).resolve().parents[1]
MOST = 1.03
"""of what a step took before"""
TASKS = ("driving", "gauze-cutting", "grasp-clutter", "platformer")
TURNS, QUICK_TURNS = 15, 1


class Side:
    """A process that runs an episode whenever it is told to; a checkout's own code runs in it."""

    def __init__(self, checkout: Path, task: str) -> None:
        environment = os.environ | {
            "PYTHONPATH": str(checkout),
            "OMP_NUM_THREADS": "1",
            "MKL_NUM_THREADS": "1",
        }
        self._process = subprocess.Popen(
            [sys.executable, str(HERE / "tools" / "sides" / "steps.py"), task],
            env=environment,
            cwd=checkout,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        self._answer()

    def step_s(self) -> tuple[float, int]:
        """CPU seconds a step of the next episode, and its steps."""
        assert self._process.stdin is not None
        self._process.stdin.write("run\n")
        self._process.stdin.flush()
        seconds, steps = self._answer().split()
        return float(seconds), int(steps)

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


def guarded(before: Path, task: str, turns: int) -> Line:
    """How much longer a step takes than before."""
    with Side(before, task) as theirs, Side(HERE, task) as ours:
        # The first episode of a process warms up.
        for side in (theirs, ours):
            side.step_s()
        pairs = []
        for turn in range(turns):
            # Whoever runs second finds the other's caches.
            first, second = (theirs, ours) if turn % 2 else (ours, theirs)
            took = {id(side): side.step_s() for side in (first, second)}
            (then_s, steps), (now_s, same) = took[id(theirs)], took[id(ours)]
            assert steps == same, "the two sides run other episodes"
            pairs.append((then_s, now_s))
        then_s, now_s = np.median(pairs, axis=0)
        ratios = [now_s / then_s for then_s, now_s in pairs]
        low, high = np.quantile(ratios, [0.25, 0.75])
        how = (
            f"{then_s * 1e3:.3f} ms a step before, {now_s * 1e3:.3f} ms now; {turns} turns, "
            f"middle half {low:.3f} .. {high:.3f}"
        )
        return at_most(float(np.median(ratios)), MOST, "of a step before", how)


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure, print a line a task, write bench-guard.json."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--before", type=Path, required=True, help="a work tree of f473395")
    parser.add_argument("--quick", action="store_true", help="one turn, to see that it runs")
    parser.add_argument("--tasks", nargs="*", choices=TASKS, default=TASKS)
    parser.add_argument("--results", type=Path, default=Path("results"), help="directory")
    options = parser.parse_args(arguments)
    found: dict[str, Line] = {}
    for task in options.tasks:
        line = guarded(options.before.resolve(), task, QUICK_TURNS if options.quick else TURNS)
        found[f"guarded step of {task}"] = line
        print(f"guarded step of {task:16} {line.value:6.3f} {line.goal} {line.how}", flush=True)
    options.results.mkdir(parents=True, exist_ok=True)
    text = json.dumps({title: asdict(line) for title, line in found.items()}, indent=2)
    (options.results / "bench-guard.json").write_text(text + "\n")


if __name__ == "__main__":
    main()
