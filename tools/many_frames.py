"""Trains a policy and its gate on many frames, and says how much memory that took.

    python -m tools.many_frames FRAMES [--pixels 64] [--folder DIRECTORY] [--gradient-steps 200]

makes a store of so many frames under DIRECTORY, a thousand an episode, maps the states as
`sheath train` does, fits the driving task's kind of policy and a gate with the default settings,
and prints a line of JSON. Memory is what no file holds, which the system cannot take back; mapped
frames lie in the page cache as long as there is room. The store takes a tenth of a byte a pixel,
the mapped states 3 bytes.
"""

import argparse
import json
import tempfile
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from sheath_manip.dataset.header import Header
from sheath_manip.dataset.layout import layout
from sheath_manip.dataset.mapped import mapped_once
from sheath_manip.dataset.recorded import Recorded
from sheath_manip.dataset.steps import recorded_of
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.gates.config import GateConfig
from sheath_manip.gates.fitted import Sources
from sheath_manip.learning.fitting import fit_gate
from sheath_manip.policies.cnn import ConvPolicy
from sheath_manip.types import ActionSpec, TaskSpec
from sheath_manip.types.samples import Samples, samples_from
from tools.synthetic import synthetic_episode, synthetic_info

EPISODE = 1000
"""frames"""
HELD_OUT, HELD_OUT_STEPS = 3, 250
"""episodes, and frames in each"""
CHOICES = np.array([[0, 0], [0.5, 0], [1, 0]], np.float32)
EVERY_S = 0.02


@dataclass(frozen=True)
class Trained:
    """What a training took."""

    frames: int
    pixels: int
    frames_mb: float
    """of the images, as they are trained on"""
    peak_mb: float
    """of the process, at most, in what no file holds"""
    mapped_s: float
    fitted_s: float
    """CPU time of policy and gate"""


def frames_store(path: Path, frames: int, pixels: int, episode: int = EPISODE) -> EpisodeStore:
    """Make a store of `frames` labelled ones: a picture that moves, unlike in each episode."""
    store = EpisodeStore.create(path)
    example = recorded_of(synthetic_episode(synthetic_info(0, 0), 2, pixels)).header
    for index in range(-(-frames // episode)):
        length = min(episode, frames - index * episode)
        store.append_arrays(_moving(example, index, length, pixels))
    return store


def _moving(example: Header, index: int, length: int, pixels: int) -> Recorded:
    info = synthetic_info(0, index)
    header = replace(example, info=info, length=length, expert_steps=length, queries=length)
    rng = np.random.default_rng(index)
    arrays = {
        spec.path: np.zeros(spec.shape, spec.dtype) for spec in layout(header) if not spec.is_image
    }
    picture = np.repeat(rng.integers(0, 256, (2 * pixels, pixels // 8, 3), np.uint8), 8, axis=1)
    rows = rng.integers(0, pixels, length)
    for spec in layout(header):
        if spec.is_film:
            arrays[spec.path] = np.stack([picture[row : row + pixels] for row in rows])
        elif spec.is_image:
            arrays[spec.path] = picture[:pixels]
    # By where the picture is: something can be learned.
    choice = CHOICES[rows * len(CHOICES) // pixels]
    noise = rng.random((length, header.feature_size), np.float32)
    flags = np.ones(length, bool)
    arrays |= {"labelled": choice, "executed": choice, "proposed": choice, "features": noise}
    arrays |= dict.fromkeys(("has_labelled", "has_proposed", "query", "intervention"), flags)
    arrays["actor"] = np.full(length, header.actors.index("expert"), np.uint8)
    return Recorded(header, arrays)


def frames_spec(store: EpisodeStore, pixels: int) -> TaskSpec:
    """Return the task that such frames are of."""
    header = store.header(store.names()[0])
    names = tuple(f"feature_{number}" for number in range(header.feature_size))
    low, high = CHOICES.min(axis=0), CHOICES.max(axis=0)
    return TaskSpec(
        name=header.info.task,
        control_rate_hz=header.info.control_rate_hz,
        action=ActionSpec(("steering_rad", "speed_m_s"), low, high, CHOICES),
        cameras={"front": (pixels, pixels)},
        feature_names=names,
        max_steps=EPISODE,
        metric="distance_m",
    )


def refit(policy: ConvPolicy, states: Samples, calibration: Sequence[Samples]) -> None:
    """Fit the policy, warm after the first time, and its gate."""
    policy.fit(states)
    fit_gate(policy, states, calibration, GateConfig(), sources=Sources((), ()))


def trained(folder: Path, frames: int, pixels: int, gradient_steps: int) -> Trained:
    """Make the frames and train on them."""
    store = frames_store(folder / "store", frames, pixels)
    held_out = frames_store(folder / "held-out", HELD_OUT * HELD_OUT_STEPS, pixels, HELD_OUT_STEPS)
    spec = frames_spec(store, pixels)
    policy = ConvPolicy(spec, warm_steps=gradient_steps)
    with anonymous_peak() as peak:
        began_s = time.process_time()
        states = mapped_once(store, store.names(), folder / "checkpoint.npz")
        mapped_s = time.process_time() - began_s
        calibration = [samples_from([episode]) for episode in held_out.episodes()]
        # The first fit would pass over all frames many times, which takes no more memory.
        policy.fit(states.take(np.arange(min(len(states), 256))))
        refit(policy, states, calibration)
    fitted_s = time.process_time() - began_s - mapped_s
    frames_mb = sum(images.nbytes for images in states.images.values()) / 1e6
    return Trained(len(states), pixels, frames_mb, max(peak) / 1e6, mapped_s, fitted_s)


@contextmanager
def anonymous_peak() -> Iterator[list[int]]:
    """Give a list of how many bytes the process held of memory that no file is behind."""
    found, ended = [anonymous_bytes()], threading.Event()

    def watch() -> None:
        while not ended.wait(EVERY_S):
            found.append(anonymous_bytes())

    watching = threading.Thread(target=watch, daemon=True)
    watching.start()
    try:
        yield found
    finally:
        ended.set()
        watching.join()


def anonymous_bytes() -> int:
    """Return what proc(5) says of this process."""
    status = Path("/proc/self/status").read_text()
    return 1024 * int(status.partition("RssAnon:")[2].split()[0])


def main(arguments: Sequence[str] | None = None) -> None:
    """Run from the command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("frames", type=int)
    parser.add_argument("--pixels", type=int, default=64)
    parser.add_argument("--folder", type=Path, default=Path())
    parser.add_argument("--gradient-steps", type=int, default=200)
    options = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory(dir=options.folder) as folder:
        done = trained(Path(folder), options.frames, options.pixels, options.gradient_steps)
    print(json.dumps(done.__dict__))


if __name__ == "__main__":
    main()
