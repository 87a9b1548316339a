"""LeRobot's ACT drives and learns under our gate; trained by LeRobot on sets that LeRobot wrote.

    python -m tools.lerobot --runs RUNS [--results results/outside/lerobot-act.json] [--quick]

in a venv with LeRobot 0.4, such as `python -m tools.foreign_readers VENVS --readers lerobot` makes.
What is done is kept in RUNS, and a second call goes on from there.
"""

import argparse
import logging
import os
import time
from collections.abc import Sequence
from dataclasses import asdict, replace
from importlib.metadata import version
from pathlib import Path

# Before anything asks for them: nothing is to be fetched, and no bar to be drawn into a log.
os.environ |= {"HF_HUB_OFFLINE": "1", "TQDM_DISABLE": "1", "HF_DATASETS_DISABLE_PROGRESS_BARS": "1"}

import torch

import tools.readers.declare_torchvision  # noqa: F401
from sheath_manip.files.json_files import plain, write_json
from tools.lerobot.bars import bars
from tools.lerobot.rounds import Plan, Run

QUICK = Plan(
    demonstrations=3, calibration=3, fresh=3, rounds=1, episodes=2, steps=60, final=3, judged=1
)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run from the command line; the exit code is 1 where a bar is missed."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--runs", type=Path, required=True, help="folder of what is done so far")
    parser.add_argument(
        "--results", type=Path, default=Path("results", "outside", "lerobot-act.json")
    )
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument(
        "--quick", action="store_true", help="a minute's worth, which shows nothing"
    )
    options = parser.parse_args(arguments)
    plan = replace(QUICK if options.quick else Plan(), seed=options.seed)
    folder = options.runs / f"{'quick' if options.quick else plan.variant}-s{plan.seed}"
    folder.mkdir(parents=True, exist_ok=True)
    torch.set_num_threads(1)
    begin = time.perf_counter()

    def say(line: str) -> None:
        print(f"[{time.perf_counter() - begin:6.0f} s] {line}", flush=True)

    logging.disable(logging.INFO)
    options.results.parent.mkdir(parents=True, exist_ok=True)
    held: dict[str, bool] = {}
    for results in Run(plan, folder, say).stages():
        held = bars(results)
        content = {"versions": versions(), "plan": asdict(plan), **results, "bars": held}
        write_json(options.results, plain(content))
    for bar, holds in held.items():
        print(f"{'holds ' if holds else 'MISSED'} {bar}")
    return 0 if all(held.values()) else 1


def versions() -> dict[str, str]:
    """Return what it was run with."""
    return {name: version(name) for name in ("lerobot", "torch", "mujoco")}


if __name__ == "__main__":
    raise SystemExit(main())
