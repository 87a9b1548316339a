"""Other projects' own loaders read what is exported here, each in a venv without this project.

    python -m tools.foreign_readers DIRECTORY [--readers zarr2 robomimic ...] [--store STORE]

makes the venvs under DIRECTORY, once, exports the episodes of STORE (by default some synthetic
ones), and compares what each loader gives with what was stored. LeRobot's own policies are held
against themselves too, as they drive in this project's loop. robomimic and LeRobot are installed
with the few packages that they import for this, since all that they ask for takes gigabytes.
"""

import argparse
import os
import subprocess
import sys
import tempfile
import venv
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from sheath_manip.dataset.exchange.actions import REQUESTED, requested
from sheath_manip.dataset.exchange.exporting import export
from sheath_manip.dataset.exchange.selection import Selection, selected
from sheath_manip.dataset.reader import EpisodeReader
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.types import Outcome
from tools.synthetic import synthetic_episode, synthetic_info

SCRIPTS = Path(__file__).parent / "readers"


@dataclass(frozen=True)
class Reader:
    """One loader, and what it reads."""

    format: str
    targets: tuple[str, ...]
    """file names to export to"""
    script: str
    packages: tuple[str, ...]
    bare: tuple[str, ...] = ()
    """packages to install without what they ask for"""
    writer: str = ""
    """script that exports, where only the venv can"""
    drivers: tuple[str, ...] = ()
    """scripts in which policies of the venv's drive in this project's loop"""


READERS = {
    "zarr2": Reader(
        "replay-buffer",
        ("demos.zarr", "demos.zarr.zip"),
        "read_replay_buffer.py",
        # 0.16 of numcodecs dropped what zarr 2 imports.
        ("zarr==2.18.7", "numcodecs==0.15.1"),
    ),
    "robomimic": Reader(
        "robomimic",
        ("demos.hdf5",),
        "read_robomimic.py",
        ("h5py==3.16.0", "torch==2.13.0", "numpy==2.4.6", "tqdm", "termcolor"),
        bare=("robomimic==0.3.0",),
    ),
    "minari": Reader(
        "minari",
        ("demos-v0",),
        "read_minari.py",
        ("minari[hdf5]==0.5.4", "pillow"),
    ),
    "lerobot": Reader(
        "lerobot",
        ("demos",),
        "read_lerobot.py",
        (
            "accelerate<2",
            "av<16",
            "datasets>=4,<5",
            "deepdiff<9",
            "draccus==0.10.0",
            "einops",
            "gymnasium",
            "huggingface-hub<0.36",
            "imageio",
            "jsonlines",
            # From 2.4 numpy refuses what LeRobot 0.4 does with values of shape (1,).
            "numpy==2.3.*",
            "packaging<26",
            "pandas",
            "pillow",
            "pyserial",
            "termcolor",
            "torch==2.13.0",
            # What diffusers asks for, of which nothing else is to be taken.
            "importlib-metadata",
            "regex",
            "requests",
            "safetensors",
            # For our side of its writer, and for the loop and a gate.
            "opencv-python-headless",
            "rich",
            "scikit-learn",
            "scipy",
            "threadpoolctl",
            "zarr==3.1.6",
        ),
        bare=("diffusers==0.35.2", "lerobot==0.4.4", "torchvision==0.28.0"),
        writer="write_lerobot.py",
        drivers=("drive_lerobot.py", "gate_lerobot.py"),
    ),
}


def make_venv(directory: Path, reader: Reader) -> Path:
    """The Python of a venv with the reader's packages, made at the first call."""
    python, stamp = directory / "bin" / "python", directory / ".complete"
    if not stamp.exists():
        venv.create(directory, with_pip=True, clear=directory.exists())
        pip = [str(python), "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
        subprocess.run([*pip, *reader.packages], check=True, env=_without_project())
        if reader.bare:
            subprocess.run([*pip, "--no-deps", *reader.bare], check=True, env=_without_project())
        stamp.touch()
    return python


def synthetic_store(path: Path, episodes: int = 4, length: int = 70) -> EpisodeStore:
    """Episodes of noise, longer than a chunk, of several lengths and outcomes."""
    store = EpisodeStore.create(path)
    for index in range(episodes):
        episode = synthetic_episode(synthetic_info(0, index), length + index, pixels=12)
        ended = index % 2 == 0
        outcome = Outcome.SUCCESS if ended else Outcome.TIME_LIMIT
        # A command filter was in between: asked for was more than was done.
        slowed = replace(episode.steps[0], executed=episode.steps[0].executed / 2)
        episode = replace(episode, steps=(slowed, *episode.steps[1:]))
        store.append(replace(episode, terminated=ended, truncated=not ended, outcome=outcome))
    return store


def write_expected(store: EpisodeReader, path: Path) -> None:
    """The arrays of all episodes as `NUMBER/NAME`, for scripts that know nothing of ours."""
    arrays = {}
    for number, recorded in enumerate(selected(store, Selection())):
        held = {**recorded.arrays, REQUESTED: requested(recorded)}
        arrays |= {f"{number}/{name}": array for name, array in held.items()}
        arrays["episodes"] = np.array(number + 1)
    np.savez(path, **arrays)


def read_back(reader: Reader, python: Path, store: EpisodeStore, folder: Path) -> list[str]:
    """Export `store` into `folder` and let the reader compare; what it said of each target.

    Raises CalledProcessError where the two differ; the reader's error is printed before.
    """
    expected, said = folder / "expected.npz", []
    write_expected(store, expected)
    for target in reader.targets:
        out = folder / target
        if reader.writer:
            run(python, reader.writer, store.path, out, project=True)
        else:
            export(store, out, reader.format, Selection())
        said.append(run(python, reader.script, out, expected))
    return said


def drive(reader: Reader, python: Path, folder: Path) -> list[str]:
    """Have policies of the venv's drive in our loop; what was said of it.

    Raises CalledProcessError where one does not as in its own; the error is printed before.
    """
    return [
        run(python, script, folder / Path(script).stem, project=True) for script in reader.drivers
    ]


def run(python: Path, script: str, *arguments: Path, project: bool = False) -> str:
    """The last line that a script prints in a venv."""
    environment = _without_project()
    # LeRobot would ask its hub about a data set that is here; nobody answers.
    environment |= {"HF_HUB_OFFLINE": "1", "HF_DATASETS_DISABLE_PROGRESS_BARS": "1"}
    if project:
        environment["PYTHONPATH"] = str(SCRIPTS.parents[1])
    done = subprocess.run(
        [str(python.absolute()), str(SCRIPTS / script), *map(str, arguments)],
        env=environment,
        stdout=subprocess.PIPE,
        text=True,
        check=True,
    )
    return done.stdout.strip().splitlines()[-1]


def _without_project() -> dict[str, str]:
    return {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run from the command line; the exit code is 1 where a reader differs."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("directory", type=Path, help="for the venvs")
    parser.add_argument("--readers", nargs="+", choices=READERS, default=list(READERS))
    parser.add_argument("--store", type=Path, help="episodes to export")
    options = parser.parse_args(arguments)
    failed = 0
    for name in options.readers:
        with tempfile.TemporaryDirectory() as folder:
            store = (
                EpisodeStore(options.store)
                if options.store
                else synthetic_store(Path(folder, "store"))
            )
            try:
                python = make_venv(options.directory / name, READERS[name])
                for line in read_back(READERS[name], python, store, Path(folder)):
                    print(line, flush=True)
                for line in drive(READERS[name], python, Path(folder)):
                    print(line, flush=True)
            except subprocess.CalledProcessError as error:
                print(f"{name}: FAILED ({error})", flush=True)
                failed += 1
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
