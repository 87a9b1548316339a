"""What recording costs, and how fast frames are drawn for training.

    python -m tools.bench_data [--quick] [--results DIRECTORY]

writes bench-data.json, which `sheath claims` reads. Times are of the wall clock, since much of them
is waiting for the disk: nothing else should run beside it. --quick takes other sizes, to see that
it runs.
"""

import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sheath_manip.dataset.mapped import mapped_samples
from sheath_manip.dataset.samples import Samples, samples_from
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.gates.constant import AlwaysExpert
from sheath_manip.rollout import rollout
from sheath_manip.types import EpisodeInfo, Purpose
from tasks.table import TASKS
from tools.bench import Line, at_most, run_bench
from tools.kill_recorder import synthetic_episode, synthetic_info

BATCH = 256


@dataclass(frozen=True)
class Sizes:
    """How much is measured."""

    task_episodes: int = 5
    """recorded, of each task"""
    stored_episodes: int = 20
    steps: int = 300
    pixels: int = 84
    draws: int = 50


QUICK = Sizes(task_episodes=1, stored_episodes=2, steps=40, pixels=16, draws=5)


def recording_lines(sizes: Sizes) -> dict[str, Line]:
    """The share of an expert episode's time that is spent on recording it."""
    lines = {}
    for name, task in TASKS.items():
        environment = task.make()
        expert, ran_s, recorded_s, steps = task.expert(environment), [], [], 0
        with tempfile.TemporaryDirectory(dir=".") as folder:
            store = EpisodeStore.create(Path(folder, "store"))
            for index in range(sizes.task_episodes + 1):
                info = EpisodeInfo(
                    name,
                    70_000 + index,
                    Purpose.DEMONSTRATION,
                    environment.spec.control_rate_hz,
                    index=index,
                )
                start_s = time.perf_counter()
                episode = rollout(
                    environment,
                    info,
                    AlwaysExpert(),
                    rng=np.random.default_rng(index),
                    expert=expert,
                )
                middle_s = time.perf_counter()
                store.append(episode)
                # The first one compiles, imports and fills caches.
                if index:
                    ran_s.append(middle_s - start_s)
                    recorded_s.append(time.perf_counter() - middle_s)
                    steps += len(episode)
        environment.close()
        spent_s, simulated_s = np.median(recorded_s), np.median(ran_s)
        paced_s = steps / sizes.task_episodes / environment.spec.control_rate_hz
        how = f"EpisodeStore.append takes {1e3 * spent_s:.0f} ms, synced; median of {len(ran_s)}"
        for pace, whole_s in (("as fast as it simulates", simulated_s), ("in real time", paced_s)):
            lines[f"recording, {name}, {pace}"] = at_most(
                100 * spent_s / (whole_s + spent_s),
                2,
                "% of the episode's time",
                f"{how}, of an episode of {whole_s:.2f} s",
            )
    return lines


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
