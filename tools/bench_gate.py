"""What a gate costs: its support against scikit-learn's one-class SVM, and its step against none.

    python -m tools.bench_gate [--quick] [--results DIRECTORY]

writes bench-gate.json, which `sheath claims` reads. A step under a gate is one look of the policy
and the gate's judgement of that look; without it is the look alone, with policy and gate of the
task's plan `full`, fitted to fewer demonstrations than that has.

Times are of the CPU on one thread, so that other processes matter little; both sides of a ratio
take turns within one run, and it is that of their medians. A batch alone is timed by the clock and
with the threads that numpy takes when it is left alone, as a user gets it, so leave the machine
idle; its line tells what one thread does as well. --quick takes other sizes, to see that it runs.
"""

import itertools
import multiprocessing
import os
import resource
import time
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray
from sklearn.svm import OneClassSVM
from threadpoolctl import threadpool_limits

from sheath_manip.learning.drivers import ExpertAlone
from sheath_manip.rollout.request import EpisodeRequest
from sheath_manip.rollout.serial import SerialExecutor
from sheath_manip.rollout.threads import single_threaded
from sheath_manip.support.one_class_svm import OneClassSupport
from sheath_manip.tasks.table import TASKS
from sheath_manip.types import EpisodeInfo, Purpose
from tools.bench import Clock, Line, at_least, at_most, medians, run_bench, spent_s
from tools.judged_lines import judged_lines

NU = 0.1
DRAFT_BANDWIDTH = 0.01
SCORE_DIMENSIONS, FIT_DIMENSIONS, MANIFOLD_DIMENSIONS = 128, 64, 6
# Scores are float32's: within this of the boundary, in units of the sum of duals, a sign is noise.
BAND = 1e-6


@dataclass(frozen=True)
class Sizes:
    """How much is measured."""

    vectors: tuple[int, int] = (1_000, 10_000)
    """support vectors"""
    score_rounds: int = 25
    calls: int = 50
    """scores of one state between turns"""
    points: int = 20_000
    fit_rounds: int = 3
    many_points: int = 200_000
    draft_points: int = 11_000
    """expert's states of the platformer, under the draft's gate"""
    demonstrations: int = 30
    held_out: int = 5
    """expert episodes that the gate is calibrated on"""


QUICK = Sizes(
    (200, 500),
    score_rounds=3,
    calls=5,
    points=5_200,
    fit_rounds=1,
    many_points=5_500,
    draft_points=1_000,
    demonstrations=3,
    held_out=3,
)


def manifold(rng: np.random.Generator, count: int, width: int) -> NDArray[np.float64]:
    """(count, width) points near a bent manifold of few dimensions, as a policy's embedding is."""
    bend = np.random.default_rng(1).normal(size=(MANIFOLD_DIMENSIONS, width))
    flat = rng.normal(size=(count, MANIFOLD_DIMENSIONS))
    return np.tanh(flat @ bend) + 0.05 * rng.normal(size=(count, width))


def isotropic(rng: np.random.Generator, count: int, width: int) -> NDArray[np.float64]:
    """(count, width) normal points."""
    return rng.normal(size=(count, width))


def reference(points: NDArray, nu: float, c: float) -> OneClassSVM:
    """scikit-learn's fit with the same bandwidth."""
    # Its stubs know only the strings that gamma may be.
    return OneClassSVM(nu=nu, gamma=1 / c).fit(points)  # pyright: ignore[reportArgumentType]


def of_reference(machine: OneClassSVM, c: float) -> OneClassSupport:
    """A support with the vectors, duals and offset of scikit-learn's."""
    duals = np.asarray(machine.dual_coef_)[0]
    vectors = np.asarray(machine.support_vectors_)
    center = vectors.mean(axis=0)
    arrays = {
        "center": center,
        "vectors": vectors - center,
        "weights": duals / duals.sum(),
        "c": np.array(c),
        "rho": np.array(np.ravel(machine.offset_)[0] / duals.sum()),
    }
    return OneClassSupport().load(arrays)


def score_lines(sizes: Sizes) -> dict[str, Line]:
    """States one by one and in a batch, where nearly every point is a support vector."""
    lines = {}
    rng = np.random.default_rng(0)
    states = rng.normal(size=(256, SCORE_DIMENSIONS)).astype(np.float32)
    c = 2.0 * SCORE_DIMENSIONS
    few, many = (
        reference(isotropic(rng, count, SCORE_DIMENSIONS), 0.9999, c) for count in sizes.vectors
    )
    for machine, least in ((few, 15), (many, 8)):
        line = f"score, 1 states, {len(machine.support_)} vectors"
        theirs, ours = score_s(machine, c, states[:1], sizes.score_rounds, sizes.calls)
        how = f"{SCORE_DIMENSIONS} dimensions, {ours * 1e6:.0f} µs against {theirs * 1e6:.0f}"
        lines[line] = at_least(theirs / ours, least, "times as fast", how)
    theirs, ours = score_s(many, c, states, sizes.score_rounds)
    one_thread = theirs / ours
    cores = os.cpu_count() or 1
    with threadpool_limits(cores):
        theirs, ours = score_s(many, c, states, sizes.score_rounds, clock=time.perf_counter)
    lines[f"score, {len(states)} states, {len(many.support_)} vectors"] = at_least(
        theirs / ours,
        20,
        "times as fast",
        f"{SCORE_DIMENSIONS} dimensions, {ours * 1e6:.0f} µs against {theirs * 1e6:.0f} by the "
        f"clock, {cores} cores, of which libsvm uses one; on one thread {one_thread:.1f} times",
    )
    return lines


def score_s(
    machine: OneClassSVM,
    c: float,
    states: NDArray[np.float32],
    rounds: int,
    calls: int = 1,
    clock: Clock = time.process_time,
) -> list[float]:
    """Median seconds of scikit-learn's scores of the states and of ours."""
    support = of_reference(machine, c)
    return medians(
        lambda: machine.decision_function(states),
        lambda: support.decision_function(states),
        rounds,
        calls,
        clock,
    )


def fit_lines(sizes: Sizes) -> dict[str, Line]:
    """A fit, its agreement with scikit-learn's, and a refit after a fifth more data."""
    lines = {}
    for kind in (manifold, isotropic):
        rng = np.random.default_rng(2)
        points = kind(rng, sizes.points, FIT_DIMENSIONS)
        held_out = kind(rng, 5_000, FIT_DIMENSIONS) * rng.uniform(0.8, 1.3, size=(5_000, 1))
        support = OneClassSupport(NU).fit(points)
        machine = reference(points, NU, support.c_)
        theirs, ours = medians(
            lambda p=points, c=support.c_: reference(p, NU, c),
            lambda p=points: OneClassSupport(NU).fit(p),
            sizes.fit_rounds,
        )
        what = f"{kind.__name__} points at {FIT_DIMENSIONS} dimensions, nu {NU:g}"
        how = f"{what}, {ours:.2f} CPU s against {theirs:.2f}, in turns"
        name = f"{sizes.points} {kind.__name__} points"
        lines[f"fit {name}"] = at_most(ours / theirs, 0.2, "of sklearn's CPU time", how)
        expected = machine.decision_function(held_out) / np.asarray(machine.dual_coef_).sum()
        share = np.mean((expected >= 0) == (support.decision_function(held_out) >= 0))
        how = f"{len(held_out)} new states, {np.mean(expected >= 0):.0%} of them inside"
        lines[f"agreement, {name}"] = at_least(share, 0.999, "share", how)
        scores = of_reference(machine, support.c_).decision_function(held_out)
        share = np.mean((np.sign(scores) == np.sign(expected))[np.abs(expected) > BAND])
        how += f", sklearn's vectors, beyond {BAND:g}·sum(alpha) of the boundary"
        lines[f"same sign, {name}"] = at_least(share, 1, "share", how)

        more = np.concatenate([points, kind(rng, sizes.points // 5, FIT_DIMENSIONS)])
        cold, warm = [], []
        for _ in range(2 * sizes.fit_rounds):
            before = OneClassSupport(NU).fit(points)
            for spent, fit in ((cold, OneClassSupport(NU).fit), (warm, before.refit)):
                spent.append(spent_s(partial(fit, more)))
        how = f"{np.median(warm):.2f} CPU s against {np.median(cold):.2f}, in turns, a fifth more"
        ratio = np.median(warm) / np.median(cold)
        lines[f"refit {name}"] = at_most(ratio, 1, "of a cold fit's CPU time", how)
    return lines


def large_fit(count: int) -> tuple[float, float]:
    """CPU seconds of one fit and the GiB that its process held at most, the points included."""
    points = manifold(np.random.default_rng(3), count, FIT_DIMENSIONS)
    with single_threaded():
        spent = spent_s(lambda: OneClassSupport(NU).fit(points))
    # Linux counts KiB.
    return spent, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20


def large_lines(sizes: Sizes) -> dict[str, Line]:
    """A fit of many points in a process of its own."""
    spawn = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(1, mp_context=spawn) as pool:
        spent, held = pool.submit(large_fit, sizes.many_points).result()
    how = f"manifold points at {FIT_DIMENSIONS} dimensions, nu {NU:g}, once, in its own process"
    return {
        f"fit {sizes.many_points} points": at_most(spent, 60, "CPU s", how),
        f"memory, {sizes.many_points} points": at_most(held, 4, "GiB", how),
    }


def draft_fit(states: NDArray) -> tuple[float, float, float]:
    """CPU seconds of one fit, the GiB that its process held at most, and the share of vectors."""
    with single_threaded():
        support = OneClassSupport(NU, DRAFT_BANDWIDTH, bandwidth_unit="dimensions")
        spent = spent_s(lambda: support.fit(states))
    distinct = len(np.unique(states, axis=0))
    held = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    return spent, held, len(support.kernel_sum_.weights) / distinct


def draft_lines(sizes: Sizes) -> dict[str, Line]:
    """A fit where nearly every state is a support vector, in a process of its own."""
    states = expert_states("platformer", sizes.draft_points)
    spawn = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(1, mp_context=spawn) as pool:
        spent, held, share = pool.submit(draft_fit, states).result()
    count, width = states.shape
    how = (
        f"expert's states of {width} bits, c = {DRAFT_BANDWIDTH:g}·{width}, {share:.0%} of those "
        "that differ are vectors, once, in its own process"
    )
    return {
        f"fit {count} platformer states": at_most(spent, 5, "CPU s", how),
        f"memory, {count} platformer states": at_most(held, 1.6, "GiB", how),
    }


def expert_states(name: str, count: int) -> NDArray[np.float64]:
    """(count, f) features that a task's expert comes by, episode after episode."""
    task = TASKS[name]
    environment = task.make()
    info = EpisodeInfo.of(
        environment.spec, variant="default", seed=0, purpose=Purpose.DEMONSTRATION
    )
    environment.close()
    infos = (replace(info, seed=seed, index=seed) for seed in itertools.count())
    states: list[NDArray] = []
    with SerialExecutor() as executor:
        for episode in executor.map(EpisodeRequest(task, each, ExpertAlone()) for each in infos):
            states += [step.observation.features for step in episode.steps]
            if len(states) >= count:
                break
    return np.stack(states[:count]).astype(np.float64)


def step_lines(sizes: Sizes) -> dict[str, Line]:
    """A step under a gate against a step without."""
    return judged_lines(sizes.score_rounds, sizes.demonstrations, sizes.held_out)


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure, print a line a number, write the file."""
    measures = score_lines, fit_lines, large_lines, draft_lines, step_lines
    run_bench("gate", __doc__, measures, Sizes(), QUICK, arguments)


if __name__ == "__main__":
    main()
