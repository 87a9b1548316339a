"""How soon a store is read and listed, how much memory frames take, and what a late refit takes."""

import json
import os
import subprocess
import sys
import tempfile
import time
from functools import partial
from pathlib import Path

import numpy as np

from sheath_manip.dataset.index import INDEX
from sheath_manip.dataset.mapped import mapped_once
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.policies.cnn import ConvPolicy
from sheath_manip.types.samples import samples_from
from tools.bench import Line, at_most, spent_s
from tools.many_frames import HELD_OUT, HELD_OUT_STEPS, frames_spec, frames_store, refit
from tools.synthetic import synthetic_episode, synthetic_info

READS = 31
LATE_PIXELS = 64
"""of the frames of a late refit: how long it takes in proportion does not depend on it"""


def reading_line(steps: int, pixels: int) -> dict[str, Line]:
    """An episode of noise, which nothing compresses, whole and without its images."""
    with tempfile.TemporaryDirectory(dir=".") as folder:
        store = EpisodeStore.create(Path(folder, "store"))
        name = store.append(synthetic_episode(synthetic_info(0, 0), steps, pixels))
        calls = [partial(store.read, name), partial(store.read, name, need_images=False)]
        times = [[spent_s(call) for call in calls] for _ in range(READS)]
    whole_ms, columns_ms = 1e3 * np.median(times, axis=0)
    how = (
        f"EpisodeStore.read of {steps} steps, {pixels}×{pixels}, in CPU time, median of {READS}; "
        f"{columns_ms:.1f} ms without images; one file"
    )
    return {"an episode is read": at_most(whole_ms, 5, "ms", how)}


def listing_line(episodes: int) -> dict[str, Line]:
    """All episodes at a glance, by the index and without it."""
    with tempfile.TemporaryDirectory(dir=".") as folder:
        store = EpisodeStore.create(Path(folder, "store"))
        for index in range(episodes):
            store.append(synthetic_episode(synthetic_info(0, index), 2, 2))
        index_bytes = (store.path / INDEX).stat().st_size
        listed_s = float(np.median([spent_s(EpisodeStore(store.path).infos) for _ in range(5)]))
        (store.path / INDEX).unlink()
        rebuilt_s = spent_s(EpisodeStore(store.path).infos)
    share = 10_000 / episodes
    how = (
        f"EpisodeStore.infos of {episodes}, in CPU time, median of 5; {share * rebuilt_s:.1f} s "
        f"without the index, which is made anew by that; it takes {index_bytes / episodes:.0f} "
        "bytes an episode"
    )
    return {"10,000 episodes are listed": at_most(share * listed_s, 0.5, "s", how)}


def training_line(frames: int, pixels: int) -> dict[str, Line]:
    """Frames that are trained on, in a process of its own."""
    command = [sys.executable, "-m", "tools.many_frames", str(frames), "--pixels", str(pixels)]
    begin_s = time.perf_counter()
    # Wherever this runs; what the process says to stderr is seen, and tells why where it fails.
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[1])}
    done = subprocess.run(command, env=environment, stdout=subprocess.PIPE, text=True, check=True)
    told = json.loads(done.stdout.splitlines()[-1])
    how = (
        f"`python -m tools.many_frames {frames} --pixels {pixels}`: {told['frames_mb'] / 1e3:.1f} "
        f"GB of images, memory that no file is behind, at most; mapped in {told['mapped_s']:.0f} "
        f"CPU s, policy (200 gradient steps) and gate in {told['fitted_s']:.0f}; "
        f"{time.perf_counter() - begin_s:.0f} s in all"
    )
    return {f"{frames:,} frames are trained on": at_most(told["peak_mb"] / 1024, 8, "GiB", how)}


def refit_line(states: int) -> dict[str, Line]:
    """A refit of policy and gate on so many states, against one on half of them."""
    with tempfile.TemporaryDirectory(dir=".") as name:
        folder = Path(name)
        store = frames_store(folder / "store", states, LATE_PIXELS)
        held_out = frames_store(
            folder / "held-out", HELD_OUT * HELD_OUT_STEPS, LATE_PIXELS, HELD_OUT_STEPS
        )
        calibration = [samples_from([episode]) for episode in held_out.episodes()]
        whole = mapped_once(store, store.names(), folder / "checkpoint.npz")
        sides = [whole.take(np.arange(states // 2)), whole]
        policy = ConvPolicy(frames_spec(store, LATE_PIXELS), hidden=(32, 16))
        policy.fit(whole.take(np.arange(min(states, 256))))
        half_s, all_s = (spent_s(partial(refit, policy, side, calibration)) for side in sides)
    how = (
        f"CPU time of policy (warm) and gate, {all_s:.1f} s against {half_s:.1f} s; "
        "what grows with the square of the states would take 4 times as much"
    )
    return {
        f"a refit on {states:,} states": at_most(all_s / half_s, 2.2, "x that on half of them", how)
    }
