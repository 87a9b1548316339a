"""Hold a policy of demonstrations alone against itself under its gate, and at random takeovers.

    python -m tools.outside.gated lift-cameras --runs runs/outside/lift-cameras \\
        --results results/outside/lift-cameras

All ways meet the same fresh scenes, as many for each training seed as the plan has final ones, and
nothing is learned from them. In the venv of `tools.outside.learn`; a second call goes on where the
first stopped, and the results hold the training seeds that are through.
"""

import shlex
import sys
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import tyro

from sheath_manip.experiments.summary import program
from sheath_manip.experiments.takeovers.figures_of_trials import burden_of, difference
from sheath_manip.experiments.takeovers.trial import Trial, mean_share
from sheath_manip.files.json_files import plain, write_json
from sheath_manip.learning.config import LearningPlan
from sheath_manip.learning.resuming import require_same_plan
from sheath_manip.metrics import rate_interval
from tools.outside.learn import study_named
from tools.outside.on_scenes import ALONE, GATED, WAYS, OnScenes

Trials = Mapping[int, Mapping[str, Sequence[Trial]]]
"""by training seed and way"""


@dataclass(frozen=True)
class Options:
    """Say what to try."""

    study: tyro.conf.Positional[str]
    """a study of tools.outside.learn, such as lift-cameras"""
    runs: Path
    """directory for what is recorded and fitted"""
    results: Path
    """directory for summary.json"""
    plan: str = "full"
    """name of the plan"""
    seeds: tuple[int, ...] = ()
    """of the training runs; by default the plan's"""


def main(arguments: Sequence[str]) -> None:
    """Try all ways, seed by seed, and write the summary after each."""
    options = tyro.cli(Options, args=arguments, description=__doc__)
    study = study_named(options.study)
    plan = study.plan(options.plan)
    if options.seeds:
        plan = plan.changed(comparison={"seeds": options.seeds})
    options.runs.mkdir(parents=True, exist_ok=True)
    require_same_plan(plan.described(), options.runs / "plan.json")
    command = shlex.join(["python", "-m", "tools.outside.gated", *arguments])
    environment = study.task.make_for_run(plan.schedule.variant, plan.comparison.seeds[0])
    environment.close()
    trials: dict[int, Mapping[str, Sequence[Trial]]] = {}
    for seed in plan.comparison.seeds:
        trials[seed] = OnScenes(study, plan, seed, options.runs).trials()
        summary = summarised(study.name, plan, trials, environment.spec.control_rate_hz, command)
        write_json(options.results / "summary.json", summary)


def summarised(
    name: str, plan: LearningPlan, trials: Trials, control_rate_hz: float, command: str
) -> dict[str, Any]:
    """Return success, burden and difference of each way, as plain values."""
    found = {
        "experiment": name,
        "command": command,
        **program(),
        "plan": plan.described(),
        "seeds": list(trials),
        "control_rate_hz": control_rate_hz,
        "ways": {way: _found(trials, way, control_rate_hz) for way in WAYS},
    }
    return plain(found)


def _found(trials: Trials, way: str, control_rate_hz: float) -> dict[str, Any]:
    of = [trial for ways in trials.values() for trial in ways[way]]
    gated = [trial for ways in trials.values() for trial in ways[GATED]]
    won, stuck = sum(not trial.fails for trial in of), sum(trial.stuck for trial in of)
    count = len(of)
    return {
        "episodes": count,
        "success_rate": won / count,
        "failure_rate": (count - won - stuck) / count,
        "stuck_rate": stuck / count,
        "ci95": {
            "success_rate": rate_interval(won, count),
            "failure_rate": rate_interval(count - won - stuck, count),
            "stuck_rate": rate_interval(stuck, count),
        },
        "success_by_seed": {
            str(seed): float(np.mean([not trial.fails for trial in ways[way]]))
            for seed, ways in trials.items()
        },
        "burden": asdict(burden_of(of, control_rate_hz)),
        "expert_share": mean_share(of),
        # Of scenes in which the policy alone succeeds; of itself, none.
        "broken": sum(trial.fails and not trial.failing for trial in of) if way != ALONE else 0,
        "fails_more_than_gated_ci95": difference(
            [trial.seed for trial in of],
            np.array([trial.fails for trial in gated], float),
            np.array([trial.fails for trial in of], float),
        ),
    }


if __name__ == "__main__":
    main(sys.argv[1:])
