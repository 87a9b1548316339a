"""What recording costs, how fast a store is read and listed, and what many frames take.

    python -m tools.bench_data [--quick] [--results DIRECTORY]

writes bench-data.json, which `sheath claims` reads. Times are of the CPU, so that other processes
matter little. The million frames take 15 GB of the disk. --quick takes other sizes, to see that it
runs.
"""

import os
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
from tools.bench import Line, at_most, run_bench, spent_s
from tools.data_lines import listing_line, reading_line, refit_line, training_line
from tools.synthetic import synthetic_episode, synthetic_info

BATCH = 256
CALLS = time.thread_time
"""the clock of calls in a thread: the CPU time of that thread alone"""


@dataclass(frozen=True)
class Sizes:
    """How much is measured."""

    turn_s: float = 8.0
    """that the episodes of a task take, one after the other; at the end the last one is waited
    for"""
    turns: int = 5
    stored_episodes: int = 20
    steps: int = 300
    pixels: int = 84
    draws: int = 50
    read_steps: int = 200
    listed: int = 10_000
    frames: int = 1_000_000
    frame_pixels: int = 64
    late_states: int = 200_000


QUICK = Sizes(
    turn_s=0.0,
    turns=1,
    stored_episodes=2,
    steps=40,
    pixels=16,
    draws=5,
    read_steps=20,
    listed=50,
    frames=1200,
    frame_pixels=64,
    late_states=2000,
)


class ClockedRecorder(BackgroundRecorder):
    """A recorder that adds up the CPU time that it takes."""

    def __init__(self, store: EpisodeStore) -> None:
        super().__init__(store)
        self._calls_s = 0.0

    def on_end(self, episode: Episode) -> None:
        """As a recorder."""
        self._calls_s += spent_s(lambda: super(ClockedRecorder, self).on_end(episode), clock=CALLS)

    @property
    def here_s(self) -> float:
        """Seconds of its calls, and of its thread, which takes turns with the loop."""
        return self._calls_s + self._thread.submit(CALLS).result()

    @property
    def there_s(self) -> float:
        """Seconds of the process that writes."""
        stat = Path(f"/proc/{self._writer.process_id}/stat").read_text()
        # proc(5): utime and stime are the 14th and 15th; the 2nd, in brackets, may hold anything.
        user, system = stat.rpartition(")")[2].split()[11:13]
        return (int(user) + int(system)) / os.sysconf("SC_CLK_TCK")


def recording_lines(sizes: Sizes) -> dict[str, Line]:
    """What recording adds to expert episodes that follow each other as fast as they simulate.

    It is counted where it arises. The difference of two whole runs, with and without, is some
    hundredths of either, and any other process on the machine moves it by more than that.
    """
    lines = {}
    for name, task in TASKS.items():
        environment = task.make()
        rate_hz = environment.spec.control_rate_hz
        run = partial(_run, environment, task.expert(environment))
        # The first one compiles, imports and fills caches.
        one = _infos(name, rate_hz, 1)
        (first,) = run(one)
        simulated_s = len(first) / rate_hz
        infos = _infos(name, rate_hz, max(1, round(sizes.turn_s / spent_s(partial(run, one)))))
        with (
            tempfile.TemporaryDirectory(dir=".") as folder,
            # For all turns, as one does for all rounds of a training run.
            ClockedRecorder(EpisodeStore.create(Path(folder, "store"))) as recorder,
        ):
            alone = EpisodeStore.create(Path(folder, "alone"))
            turns = [_turn(run, infos, recorder, alone, number) for number in range(sizes.turns)]
        environment.close()
        episode_s, cost_s, writing_s, append_s = np.median(turns, axis=0)
        shares = [100 * cost / episode for episode, cost, *_ in turns]
        lines[f"recording, {name}"] = at_most(
            np.median(shares),
            2,
            "% longer",
            f"{1e3 * cost_s:.1f} ms to {episode_s:.2f} CPU s an episode, median of {len(turns)} "
            f"turns of {len(infos)}, largest {max(shares):.2f} %; {100 * cost_s / simulated_s:.2f} "
            f"% of the {simulated_s:.1f} s that a robot takes for one; the other process takes "
            f"{1e3 * writing_s:.1f} ms for each; an append alone takes {1e3 * append_s:.0f} ms by "
            "the clock, synced",
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
    recorder: ClockedRecorder,
    alone: EpisodeStore,
    number: int,
) -> tuple[float, float, float, float]:
    """CPU seconds of an episode, of recording it, of writing it, and those of an append to `alone`.

    The loop waits for the last one: the time in which that one is written is recording's, too.
    """
    # The same scenes under names of their own.
    infos = [replace(info, round=number) for info in infos]
    here_s, there_s, began_s = recorder.here_s, recorder.there_s, time.process_time()
    episode = run(infos, [recorder])[-1]
    recorder.flush()
    spent = time.process_time() - began_s, recorder.here_s - here_s, recorder.there_s - there_s
    episode_s, recording_s, writing_s = (each / len(infos) for each in spent)
    append_s = spent_s(lambda: alone.append(episode), clock=time.perf_counter)
    return episode_s, recording_s + writing_s / len(infos), writing_s, append_s


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
                side.append(spent_s(lambda samples=samples: _draw(samples, rng)))
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


def store_lines(sizes: Sizes) -> dict[str, Line]:
    """How soon an episode is read, and all are listed."""
    return {**reading_line(sizes.read_steps, sizes.pixels), **listing_line(sizes.listed)}


def scale_lines(sizes: Sizes) -> dict[str, Line]:
    """How much memory many frames take, and what a late refit takes."""
    return {**training_line(sizes.frames, sizes.frame_pixels), **refit_line(sizes.late_states)}


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure, print a line a number, write the file."""
    measures = (drawing_lines, store_lines, recording_lines, scale_lines)
    run_bench("data", __doc__, measures, Sizes(), QUICK, arguments)


if __name__ == "__main__":
    main()
