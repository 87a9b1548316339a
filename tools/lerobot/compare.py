"""Compare what LeRobot's ACT learns under our gate, at random takeovers and by DAgger.

    python -m tools.lerobot.compare --runs RUNS [--results SUMMARY] [--seeds 100] [--quick]

in the venv of `python -m tools.lerobot`; `comparison_plan.py` says what is compared and why. What
is done is kept in RUNS, and a second call goes on from there. Results hold the training seeds that
are through; the exit code is 1 where a bar is missed.
"""

import argparse
import sys
from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from sheath_manip.exceptions import SheathError
from sheath_manip.experiments.summary import program
from sheath_manip.files.json_files import plain, write_json
from tools.lerobot.comparison_plan import QUICK_COMPARISON, ComparisonPlan
from tools.lerobot.comparison_results import comparison_bars, through, together
from tools.lerobot.plan import claim
from tools.lerobot.readiness import get_ready, timed_say, versions


def main(arguments: Sequence[str] | None = None) -> int:
    """Run from the command line; 2 where LeRobot is not there, or RUNS is another plan's."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--runs", type=Path, required=True, help="folder of what is done so far")
    parser.add_argument(
        "--results", type=Path, default=Path("results", "outside", "lerobot-rounds", "summary.json")
    )
    parser.add_argument(
        "--quick", action="store_true", help="a minute's worth, which shows nothing"
    )
    parser.add_argument(
        "--seeds", type=int, nargs="+", help="of training runs, for tuning; by default the plan's"
    )
    options = parser.parse_args(arguments)
    plan = QUICK_COMPARISON if options.quick else ComparisonPlan()
    if options.seeds:
        plan = replace(plan, seeds=tuple(options.seeds))
    try:
        held = compare(plan, options.runs, options.results)
    except SheathError as error:
        print(error, file=sys.stderr)
        return 2
    for bar, holds in held.items():
        print(f"{'holds ' if holds else 'MISSED'} {bar}")
    return 0 if all(held.values()) else 1


def compare(plan: ComparisonPlan, folder: Path, path: Path) -> dict[str, bool]:
    """Run all training seeds, what is done left out, and return which bars hold.

    Raises SetupError where LeRobot is not there, and ParameterError for a folder of another plan.
    """
    get_ready()
    from tools.lerobot.comparison import SeedRun

    claim(folder, plan)
    path.parent.mkdir(parents=True, exist_ok=True)
    say = timed_say()
    seeds: dict[int, Mapping[str, Any]] = {}
    held: dict[str, bool] = {}
    for seed in plan.seeds:
        for found in SeedRun(plan, seed, folder / f"seed-{seed}", say).stages():
            seeds[seed] = found
        done = together(through(seeds, plan))
        held = comparison_bars(done)
        content = {
            "versions": versions(),
            **program(),
            "plan": asdict(plan),
            "seeds": list(seeds),
            "methods": done,
            "bars": held,
            "by_seed": {str(each): found for each, found in seeds.items()},
        }
        write_json(path, plain(content))
    return held


if __name__ == "__main__":
    sys.exit(main())
