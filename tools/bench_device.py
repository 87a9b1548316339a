"""What a CUDA device gives: gradient steps and searches against one core, and the same decisions.

    python -m tools.bench_device [--quick] [--results DIRECTORY]

writes bench-device.json, which `sheath claims` reads; without a CUDA device it says so and writes
nothing. Times are of the clock, since a device has no CPU time; each ends with numbers on the CPU,
which waits for all that was asked of the device. Both sides take turns. --quick takes other sizes,
to see that it runs.
"""

import os
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from sheath_manip.exceptions import SetupError
from sheath_manip.gates.config import GateConfig
from sheath_manip.gates.fitted import Sources
from sheath_manip.learning.checkpoint import Checkpoint, load_checkpoint
from sheath_manip.learning.fitting import fit_gate
from sheath_manip.policies.cnn import ConvPolicy
from sheath_manip.policies.looking import look
from sheath_manip.rollout.device import CPU, CUDA, VARIABLE, use_device
from sheath_manip.signals.nearest_rows import rows_of
from sheath_manip.types import TaskSpec
from sheath_manip.types.samples import Samples, samples_from
from tools.bench import Line, at_least, at_most, medians, run_bench
from tools.many_frames import frames_spec, frames_store


@dataclass(frozen=True)
class Sizes:
    """How much is measured."""

    states: int = 4000
    pixels: int = 84
    gradient_steps: int = 200
    rounds: int = 3
    precedents: int = 200_000
    width: int = 64
    asked: int = 4096


QUICK = Sizes(states=600, pixels=64, gradient_steps=5, rounds=1, precedents=2000, asked=256)


@contextmanager
def computing_on(name: str) -> Iterator[None]:
    """Let what is made meanwhile compute there."""
    before = os.environ.get(VARIABLE, CPU)
    use_device(name)
    try:
        yield
    finally:
        use_device(before)


def fitting_lines(sizes: Sizes) -> dict[str, Line]:
    """A gradient step of the driving task's kind of policy, and what a checkpoint decides."""
    with tempfile.TemporaryDirectory(dir=".") as name:
        folder = Path(name)
        store = frames_store(folder / "store", 2 * sizes.states, sizes.pixels, sizes.states // 4)
        spec = frames_spec(store, sizes.pixels)
        episodes = [samples_from([episode]) for episode in store.episodes()]
        states = samples_from(store.read_many(store.names()[:4]))
        policies = {each: _begun(each, spec, states, sizes) for each in (CUDA, CPU)}
        sides = [partial(_refit, name, policies[name], states) for name in (CUDA, CPU)]
        there_s, here_s = medians(*sides, rounds=sizes.rounds, clock=time.perf_counter)
        fit = fit_gate(policies[CPU], states, episodes[4:7], GateConfig(), sources=Sources((), ()))
        path = Checkpoint(spec.name, "cnn", policies[CPU], fit.gate).save(folder / "kept.npz")
        there, here = (_decided(name, path, spec, episodes[7]) for name in (CUDA, CPU))
    step_ms = 1e3 * here_s / sizes.gradient_steps
    how = f"of 128 images, {sizes.pixels}×{sizes.pixels}: {step_ms:.1f} ms on one core"
    off = float(np.abs(there[0] - here[0]).max())
    same = 100 * float((there[1] == here[1]).mean())
    judged = f"a checkpoint of the CPU, {len(here[1])} new states"
    return {
        "a gradient step": at_least(here_s / there_s, 10, "times as fast as one core", how),
        "actions": at_most(off, 1e-3, "off at most", judged),
        "gate decisions": at_least(same, 99.9, "% equal", judged),
    }


def _begun(name: str, spec: TaskSpec, states: Samples, sizes: Sizes) -> ConvPolicy:
    with computing_on(name):
        policy = ConvPolicy(spec, epochs=1, warm_epochs=1000, warm_steps=sizes.gradient_steps)
        return policy.fit(states)


def _refit(name: str, policy: ConvPolicy, states: Samples) -> None:
    with computing_on(name):
        policy.fit(states).arrays()


def _decided(
    name: str, path: Path, spec: TaskSpec, states: Samples
) -> tuple[np.ndarray, np.ndarray]:
    """Actions, and where the expert takes over."""
    with computing_on(name):
        checkpoint = load_checkpoint(path, spec)
        signal = checkpoint.fitted.signal
        assert signal is not None
        seen = look(checkpoint.policy, states, signal.attach(checkpoint.policy))
        return seen.actions, checkpoint.fitted.scores_of(seen) < checkpoint.threshold


def searching_lines(sizes: Sizes) -> dict[str, Line]:
    """The nearest of many precedents, for the states of a refit."""
    rng = np.random.default_rng(0)
    fixed, new = (
        rng.normal(size=(count, sizes.width)).astype(np.float32)
        for count in (sizes.precedents, sizes.asked)
    )
    rows = {}
    for name in (CUDA, CPU):
        with computing_on(name):
            rows[name] = rows_of(fixed)
            rows[name].nearest(new[:8])
    sides = [partial(rows[name].nearest, new) for name in (CUDA, CPU)]
    there_s, here_s = medians(*sides, rounds=sizes.rounds, clock=time.perf_counter)
    how = f"{sizes.asked} states among {sizes.precedents}, {1e3 * there_s:.1f} ms"
    return {"precedents": at_least(here_s / there_s, 10, "times as fast as one core", how)}


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure, print a line a number, write the file."""
    measures = (fitting_lines, searching_lines)
    try:
        with computing_on(CUDA):
            pass
    except SetupError as error:
        print(f"nothing measured: {error}")
        return
    run_bench("device", __doc__, measures, Sizes(), QUICK, arguments)


if __name__ == "__main__":
    main()
