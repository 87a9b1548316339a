"""What the pieces of a task's rounds cost, measured in a small run on one core of this machine.

A warm refit takes fewer gradient steps a state the more states there are (`warm_steps`), so that
no line through a small run's fits tells what those of the plan cost. Each method is fitted once
more, to as many states as the plan ends with: those of the trial over and over.
"""

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.experiments.scale.metering import EpisodeCost, MeteredExecutor
from sheath_manip.learning.checkpoint import load_checkpoint
from sheath_manip.learning.config import LearningPlan
from sheath_manip.learning.methods import Method, method_named
from sheath_manip.learning.results import round_path, round_results
from sheath_manip.learning.run import LearningRun
from sheath_manip.protocols import Report
from sheath_manip.rollout.threads import single_threaded
from sheath_manip.task import Task
from sheath_manip.types import Purpose
from sheath_manip.types.samples import Samples, joined, visited_from

ROUNDS = 2
EPISODES = 3
"""of a round of the trial"""
DEMONSTRATIONS = 20
"""of the trial, at most: the first policy is fitted to as many as in the plan"""
MOST_STATES = 10_000
"""that a method is fitted to here; more are extrapolated"""


@dataclass(frozen=True)
class Line:
    """Seconds by the number of states: `fixed_s + each_s * states`."""

    fixed_s: float
    each_s: float

    def at(self, states: float) -> float:
        """Return the seconds for so many states."""
        return self.fixed_s + self.each_s * states

    @classmethod
    def through(cls, states: Sequence[float], seconds: Sequence[float]) -> "Line":
        """Return the line of least squares, neither part of which is below nothing."""
        x, y = np.asarray(states, float), np.asarray(seconds, float)
        if np.ptp(x) > 0:
            slope, fixed = np.polyfit(x, y, 1)
            if slope >= 0 and fixed >= 0:
                return cls(float(fixed), float(slope))
            if slope < 0:
                return cls(float(y.mean()), 0.0)
        return cls(0.0, float((x @ y) / max(x @ x, 1.0)))


@dataclass(frozen=True)
class MethodCosts:
    """What a round of one method costs, in CPU seconds."""

    episode_s: float
    """an episode under its gate"""
    begin_s: float
    """what precedes its first round: reading what the expert showed, and its own gate"""
    fit: Line
    """policy and gate of a round, by the labelled states so far"""
    measure_s: float
    """what a round showed of policy and gate"""
    states_each: float
    """labelled states that an episode of it adds"""


@dataclass(frozen=True)
class Costs:
    """What the pieces of a task's rounds cost, in CPU seconds on one core."""

    expert_s: float
    """an expert's episode"""
    alone_s: float
    """an episode of the policy alone"""
    states_each: float
    """states of an expert's episode"""
    fit: Line
    """the first policy and gate, by states"""
    methods: Mapping[str, MethodCosts]
    episode_b: float
    """bytes of an episode that is recorded"""
    checkpoint_b: float
    """bytes of a checkpoint's file"""


def trial_of(plan: LearningPlan) -> LearningPlan:
    """Return a small plan with the same pieces, whose costs are those of `plan`."""
    schedule = plan.schedule
    return plan.changed(
        schedule={
            "demonstrations": min(DEMONSTRATIONS, schedule.demonstrations),
            "rounds": min(ROUNDS, schedule.rounds),
            "episodes": min(EPISODES, schedule.episodes),
        },
        comparison={"seeds": plan.comparison.seeds[:1], "evaluation_episodes": 1}
        | {"final_episodes": 1},
    )


def measure_costs(task: Task, plan: LearningPlan, directory: Path, report: Report) -> Costs:
    """Run the trial of `plan` in this process, under a new `directory`; return its costs."""
    trial, seed = trial_of(plan), plan.comparison.seeds[0]
    store = EpisodeStore.create(directory / "store")
    marks: dict[str, Mapping[str, float]] = {}
    far: dict[str, tuple[int, float]] = {}
    with single_threaded(), MeteredExecutor() as executor:

        def heard(word: str) -> None:
            if " fit " in word:
                executor.mark(word)
            report(word)

        for method in ("", *_in_order(trial)):
            executor.marks.clear()
            executor.mark("begun")
            learning = LearningRun(
                task, trial, seed, directory, store, executor, report=heard, failures=True
            )
            if method:
                learning.run(method)
            else:
                learning.prepare()
            executor.mark("done")
            marks[method] = {mark.word: mark.at_s for mark in executor.marks}
            if method:
                far[method] = _last_fit(learning, method_named(method), plan)
                report(f"{method} fit to {far[method][0]} states")
        return _costs(trial, seed, directory, executor.episodes, marks, far)


def _last_fit(learning: LearningRun, method: Method, plan: LearningPlan) -> tuple[int, float]:
    """About how many states the last round of `plan` fits to, and CPU seconds of such a fit."""
    results = round_results(learning.directory, learning.run_seed, method.name)
    number, drove = len(results) - 1, learning.plan.schedule
    each = (results[-1].states - results[0].states) / (number * drove.episodes)
    more = plan.schedule.rounds * plan.schedule.episodes * each
    states = min(MOST_STATES, max(results[-1].states, round(results[0].states + more)))
    start = learning.start()
    path = round_path(learning.directory, learning.run_seed, method.name, number, "npz")
    previous = load_checkpoint(path, learning.spec)
    episodes = learning.store.episodes(
        Purpose.LEARNING, method.name, number, learning.run_seed, need_images=True
    )
    visited = visited_from(list(episodes))
    if not visited.is_labelled.any():
        # Then only a threshold would be found.
        visited = start.demonstrations
    many = over_and_over(joined([start.demonstrations, visited.labelled()]), states)
    begin_s = time.process_time()
    given = learning.given(method, number + 1)
    start.checkpoints.refitted(method, number + 1, previous, many, visited, start.names, given)
    return states, time.process_time() - begin_s


def over_and_over(samples: Samples, count: int) -> Samples:
    """Return `count` states, those of `samples` in turn.

    Each time around their images are moved by one more pixel: a support that is fitted to states
    which come twice is another problem.
    """
    rows = np.arange(count) % len(samples)
    taken = samples.take(rows)
    moved_px = np.arange(count) // len(samples)
    for images in taken.images.values():
        for row in np.flatnonzero(moved_px):
            images[row] = np.roll(images[row], moved_px[row], axis=1)
    return taken


def _in_order(plan: LearningPlan) -> list[str]:
    """Methods, those first that others follow."""
    names = plan.comparison.methods
    return sorted(names, key=lambda name: method_named(name).burden_from is not None)


def _costs(
    trial: LearningPlan,
    seed: int,
    directory: Path,
    episodes: Sequence[EpisodeCost],
    marks: Mapping[str, Mapping[str, float]],
    far: Mapping[str, tuple[int, float]],
) -> Costs:
    schedule = trial.schedule
    alone = [each.cpu_s for each in episodes if each.info.purpose is Purpose.EVALUATION]
    recorded = [each for each in episodes if each.info.purpose is not Purpose.EVALUATION]
    by_expert = [each for each in recorded if each.info.purpose is not Purpose.LEARNING]
    first_states = round_results(directory, seed, trial.comparison.methods[0])[0].states
    methods = {}
    for name in trial.comparison.methods:
        at, results = marks[name], round_results(directory, seed, name)
        driven = [
            each.cpu_s
            for each in episodes
            if each.info.method == name and each.info.purpose is Purpose.LEARNING
        ]
        fits, measured = [], []
        for number in range(1, len(results)):
            begun, fitted = at[f"{name} round {number}"], at[f"{name} fit {number}"]
            fits.append(fitted - begun)
            measured.append(at.get(f"{name} round {number + 1}", at["done"]) - fitted)
        added = results[-1].states - first_states
        states, seconds = far[name]
        fitted_to = [*(result.states for result in results[1:]), states]
        methods[name] = MethodCosts(
            episode_s=float(np.mean(driven)),
            begin_s=at[f"{name} round 1"] - at["begun"],
            fit=Line.through(fitted_to, [*fits, seconds]),
            measure_s=float(np.mean(measured)),
            states_each=added / ((len(results) - 1) * schedule.episodes),
        )
    first_s = marks[""]["expert fit 0"] - marks[""]["begun"]
    dearest = max((each.fit for each in methods.values()), key=_seconds)
    files = [path.stat().st_size for path in directory.rglob("round-*.npz")]
    return Costs(
        expert_s=float(np.mean([each.cpu_s for each in by_expert])),
        alone_s=float(np.mean(alone)),
        states_each=first_states / schedule.demonstrations,
        fit=_like(dearest, first_states, first_s),
        methods=methods,
        episode_b=float(np.mean([each.size_b for each in recorded])),
        checkpoint_b=float(np.mean(files)),
    )


def _like(line: Line, states: float, seconds: float) -> Line:
    """A line through one point, as much of which is fixed as of another."""
    scale = seconds / line.at(states) if line.at(states) > 0 else 0.0
    return Line(line.fixed_s * scale, line.each_s * scale)


def _seconds(line: Line) -> float:
    return line.at(1e4)
