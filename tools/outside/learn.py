"""Run and resume the comparison of methods on one of the tasks beside this file.

    python -m tools.outside.learn fetch --runs runs/outside/fetch --results results/outside/fetch

In a venv with gymnasium-robotics or robosuite and MuJoCo below 3.8; docs/results/outside.md has how
it was made.
"""

import shlex
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

import tyro

from sheath_manip.experiments.learning import run_experiment
from sheath_manip.experiments.study import Study
from sheath_manip.rollout.executing import Executing

STUDIES = {
    "fetch": "tools.outside.fetch_study:STUDY",
    "lift": "tools.outside.lift_study:STUDY",
    "lift-cameras": "tools.outside.lift_cameras_study:STUDY",
}


@dataclass(frozen=True)
class Options:
    """Say what to run."""

    study: tyro.conf.Positional[str]
    """fetch, lift or lift-cameras"""
    runs: Path
    """directory for what is recorded and learned"""
    results: Path
    """directory for summary.json"""
    plan: str = "full"
    """name of the plan"""
    seeds: tuple[int, ...] = ()
    """of the training runs; by default the plan's"""
    workers: int = 0
    """processes beside this one; with 0 all runs in it"""


def study_named(name: str) -> Study:
    """Return the study of that name."""
    module, _, attribute = STUDIES[name].partition(":")
    return getattr(import_module(module), attribute)


def main(arguments: Sequence[str]) -> None:
    """Run it."""
    options = tyro.cli(Options, args=arguments, description=__doc__)
    study = study_named(options.study)
    plan = study.plan(options.plan)
    if options.seeds:
        plan = plan.changed(comparison={"seeds": options.seeds})
    run_experiment(
        study,
        plan,
        runs=options.runs,
        results=options.results,
        command=shlex.join(["python", "-m", "tools.outside.learn", *arguments]),
        executing=Executing(workers=options.workers),
        figures=(),
    )


if __name__ == "__main__":
    main(sys.argv[1:])
