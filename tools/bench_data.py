"""What recording costs, and how fast frames are drawn for training.

    python -m tools.bench_data [--quick] [--results DIRECTORY]

writes bench-data.json, which `sheath claims` reads. Times are of the wall clock, since much of them
is waiting for the disk: nothing else should run beside it. --quick takes other sizes, to see that
it runs.
"""

import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np

from sheath_manip.dataset.background import BackgroundRecorder
from sheath_manip.dataset.mapped import mapped_samples
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.gates.constant import AlwaysExpert
from sheath_manip.protocols import Environment, Expert, Listener
from sheath_manip.rollout.loop import rollout
from sheath_manip.tasks.table import TASKS
from sheath_manip.types import Episode, EpisodeInfo, Purpose
from sheath_manip.types.samples import Samples, samples_from
from tools.bench import Line, at_most, run_bench
from tools.kill_recorder import synthetic_episode, synthetic_info

BATCH = 256


@dataclass(frozen=True)
class Sizes:
    """How much is measured."""

    turn_s: float = 8.0
    """that the episodes of a task take, one after the other; at the end the last one is waited
    for"""
    turns: int = 8
    """in which they are, and are not; even, so that each of both comes first as often"""
    stored_episodes: int = 20
    steps: int = 300
    pixels: int = 84
    draws: int = 50


QUICK = Sizes(turn_s=0.0, turns=1, stored_episodes=2, steps=40, pixels=16, draws=5)


def recording_lines(sizes: Sizes) -> dict[str, Line]:
    """By how much longer expert episodes take where they are recorded, as fast as they simulate."""
    lines = {}
    for name, task in TASKS.items():
        environment = task.make()
        rate_hz = environment.spec.control_rate_hz
        run = partial(_run, environment, task.expert(environment))
        # The first one compiles, imports and fills caches.
        one = _infos(name, rate_hz, 1)
        (first,) = run(one)
        simulated_s = len(first) / rate_hz
        one_s = _spent_s(partial(run, one))
        infos = _infos(name, rate_hz, max(1, round(sizes.turn_s / one_s)))
        with (
            tempfile.TemporaryDirectory(dir=".") as folder,
            # For all turns, as one does for all rounds of a training run.
            BackgroundRecorder(EpisodeStore.create(Path(folder, "store"))) as recorder,
        ):
            alone = EpisodeStore.create(Path(folder, "alone"))
            turns = [_turn(run, infos, recorder, alone, number) for number in range(sizes.turns)]
        environment.close()
        plain_s, recorded_s, append_s = np.array(turns).T
        cost_s = np.median(recorded_s - plain_s) / len(infos)
        lines[f"recording, {name}"] = at_most(
            100 * np.median(recorded_s / plain_s - 1),
            2,
            "% longer",
            f"{len(infos)} episodes of {np.median(plain_s) / len(infos):.2f} s with and without, "
            f"in turns, median of {len(turns)}; {100 * cost_s / simulated_s:.2f} % of the "
            f"{simulated_s:.1f} s that a robot takes for one; an append alone takes "
            f"{1e3 * np.median(append_s):.0f} ms, synced",
        )
    return lines


def _infos(task: str, rate_hz: float, count: int) -> list[EpisodeInfo]:
    """Of so many expert episodes."""
    return [
        EpisodeInfo(task, 70_000 + index, Purpose.DEMONSTRATION, rate_hz, index=index)
        for index in range(count)
    ]


def _run(
    environment: Environment,
    expert: Expert,
    infos: Sequence[EpisodeInfo],
    listeners: Sequence[Listener] = (),
) -> list[Episode]:
    return [
        rollout(
            environment,
            info,
            AlwaysExpert(),
            rng=np.random.default_rng(info.index),
            expert=expert,
            listeners=listeners,
        )
        for info in infos
    ]


def _turn(
    run: Callable[..., list[Episode]],
    infos: Sequence[EpisodeInfo],
    recorder: BackgroundRecorder,
    alone: EpisodeStore,
    number: int,
) -> tuple[float, float, float]:
    """Seconds of all episodes without and with the recorder, and of one append to `alone`."""
    # The same scenes under names of their own.
    infos = [replace(info, round=number) for info in infos]

    def recorded() -> None:
        run(infos, [recorder])
        recorder.flush()

    # Who comes first changes, so that a machine that slows down favours neither.
    recorded_s = _spent_s(recorded) if number % 2 else 0.0
    plain_s = _spent_s(lambda: run(infos))
    recorded_s = recorded_s or _spent_s(recorded)
    (episode,) = run(infos[:1])
    return plain_s, recorded_s, _spent_s(lambda: alone.append(episode))


def drawing_lines(sizes: Sizes) -> dict[str, Line]:
    """A batch of random frames out of memory and out of mapped files."""
    with tempfile.TemporaryDirectory(dir=".") as folder:
        store = EpisodeStore.create(Path(folder, "store"))
        for index in range(sizes.stored_episodes):
            episode = synthetic_episode(synthetic_info(0, index), sizes.steps, sizes.pixels)
            store.append(episode)
        start_s = time.perf_counter()
        mapped = mapped_samples(store, store.names(), Path(folder, "cache"))
        built_s = time.perf_counter() - start_s
        in_memory = samples_from(store.read_many(store.names()))
        rng = np.random.default_rng(0)
        times: list[list[float]] = [[], []]
        for _ in range(sizes.draws):
            for side, samples in zip(times, (in_memory, mapped), strict=True):
                side.append(_spent_s(lambda samples=samples: _draw(samples, rng)))
        frames = f"of {len(mapped)} labelled ones, {sizes.pixels}×{sizes.pixels}"
        memory_ms, mapped_ms = 1e3 * np.median(times, axis=1)
        how = f"Samples.take {frames}, median of {sizes.draws}"
        return {
            f"{BATCH} random frames from memory": at_most(memory_ms, 5, "ms", how),
            f"{BATCH} random frames from mapped files": at_most(
                mapped_ms, 5, "ms", f"{how}; built once in {built_s:.1f} s"
            ),
        }


def _draw(samples: Samples, rng: np.random.Generator) -> Samples:
    return samples.take(rng.integers(0, len(samples), BATCH))


def _spent_s(call: Callable[[], object]) -> float:
    start_s = time.perf_counter()
    call()
    return time.perf_counter() - start_s


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure, print a line a number, write the file."""
    run_bench("data", __doc__, (drawing_lines, recording_lines), Sizes(), QUICK, arguments)


if __name__ == "__main__":
    main()
