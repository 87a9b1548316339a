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
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

import numpy as np

from tools.bench import Line, at_most
from tools.side import HERE, Side

STEPS = "steps.py"
MOST = 1.03
"""of what a step took before"""
TASKS = ("driving", "gauze-cutting", "grasp-clutter", "platformer")
TURNS, QUICK_TURNS = 15, 1


def guarded(before: Path, task: str, turns: int) -> Line:
    """How much longer a step takes than before."""
    with Side(before, STEPS, task) as theirs, Side(HERE, STEPS, task) as ours:
        # CPU seconds of a step, simulation, cameras and expert included.
        step_s = min(theirs.first, ours.first)
        pairs = []
        for turn in range(turns):
            # The second finds the other's caches.
            order = (theirs, ours) if turn % 2 else (ours, theirs)
            took = {id(side): side.measured() for side in order}
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
