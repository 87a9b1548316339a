"""What it costs a control step that whatever fails in it is survived.

    python -m tools.bench_guard --before CHECKOUT [--quick] [--results DIRECTORY]

writes bench-guard.json, which `sheath claims` reads. CHECKOUT is a work tree of the version that is
held against, f473395. Each side is a process of its own that runs an episode, in which the expert's
actions are proposed by a policy and judged by a support gate, and then the same steps again and
again as they were recorded, without simulation, cameras and expert: what is left is the loop. The
sides take turns; times are of their CPU on one thread, medians. A gate's score and a network's look
come on top of a step and are not counted, so that the share is on the safe side.
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
        self.whole_s = float(self._answer())
        """CPU seconds of a step, simulation, cameras and expert included"""

    def loop_s(self) -> float:
        """CPU seconds of the loop in a step of the same episode as it was recorded."""
        assert self._process.stdin is not None
        self._process.stdin.write("run\n")
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


def guarded(before: Path, task: str, turns: int) -> Line:
    """How much longer a step takes than before."""
    with Side(before, task) as theirs, Side(HERE, task) as ours:
        step_s = min(theirs.whole_s, ours.whole_s)
        pairs = []
        for turn in range(turns):
            # The second finds the other's caches.
            order = (theirs, ours) if turn % 2 else (ours, theirs)
            took = {id(side): side.loop_s() for side in order}
            pairs.append((took[id(theirs)], took[id(ours)]))
        then_s, now_s = np.median(pairs, axis=0)
        low_s, high_s = np.quantile([now - then for then, now in pairs], [0.25, 0.75])
        how = (
            f"the loop's own {then_s * 1e6:.1f} us before, {now_s * 1e6:.1f} us now (difference "
            f"{low_s * 1e6:.1f} .. {high_s * 1e6:.1f}), of {step_s * 1e3:.2f} ms a step"
        )
        share = 1 + (now_s - then_s) / step_s
        return at_most(share, MOST, "of a step before", how)


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
    path = options.results / "bench-guard.json"
    # A task that is not asked for keeps its line.
    written = json.loads(path.read_text()) if path.exists() else {}
    options.results.mkdir(parents=True, exist_ok=True)
    for task in options.tasks:
        line = guarded(options.before.resolve(), task, QUICK_TURNS if options.quick else TURNS)
        written[f"guarded step of {task}"] = asdict(line)
        print(f"guarded step of {task:16} {line.value:6.3f} {line.goal} {line.how}", flush=True)
        path.write_text(json.dumps(written, indent=2) + "\n")


if __name__ == "__main__":
    main()
