"""LeRobot's ACT drives and learns under our gate; trained by LeRobot on sets that LeRobot wrote.

    python -m tools.lerobot --runs RUNS [--results results/outside/lerobot-act.json] [--quick]

in a venv with LeRobot 0.4 and the extra `tasks` of this project. What is done is kept in RUNS, and
a second call goes on from there. Results are written after each stage; the exit code is 1 where a
bar is missed.
"""

import argparse
import sys
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from sheath_manip.exceptions import SheathError
from sheath_manip.files.json_files import plain, write_json
from tools.lerobot.bars import bars
from tools.lerobot.plan import QUICK, Plan
from tools.lerobot.readiness import get_ready, timed_say, versions


def main(arguments: Sequence[str] | None = None) -> int:
    """Run from the command line; 2 where LeRobot is not there, or RUNS is another plan's."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--runs", type=Path, required=True, help="folder of what is done so far")
    parser.add_argument(
        "--results", type=Path, default=Path("results", "outside", "lerobot-act.json")
    )
    parser.add_argument(
        "--quick", action="store_true", help="a minute's worth, which shows nothing"
    )
    options = parser.parse_args(arguments)
    try:
        held = run(QUICK if options.quick else Plan(), options.runs, options.results)
    except SheathError as error:
        print(error, file=sys.stderr)
        return 2
    for bar, holds in held.items():
        print(f"{'holds ' if holds else 'MISSED'} {bar}")
    return 0 if all(held.values()) else 1


def run(plan: Plan, folder: Path, path: Path) -> dict[str, bool]:
    """Run all stages, those that are done left out, and return which bars hold.

    Raises SetupError where LeRobot is not there, and ParameterError for a folder of another plan.
    """
    get_ready()
    from tools.lerobot.rounds import Run

    path.parent.mkdir(parents=True, exist_ok=True)
    held: dict[str, bool] = {}
    for results in Run(plan, folder, timed_say()).stages():
        held = bars(results)
        content = {"versions": versions(), "plan": asdict(plan), **results, "bars": held}
        write_json(path, plain(content))
    return held


if __name__ == "__main__":
    sys.exit(main())
