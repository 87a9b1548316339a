"""Other projects' own libraries write a small data set, and it comes in here as it was.

    python -m tools.foreign_writers DIRECTORY [--writers lerobot-v3.0 ...] [--keep FOLDER]

makes the venvs under DIRECTORY, once, lets each library write, imports what it wrote and compares:
states, actions, rewards and interventions to the bit, images within the error of their codec. What
was written is kept in FOLDER: `tests/dataset/exchange/sets` is made so.
"""

import argparse
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sheath_manip.dataset.exchange.sources import import_data
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.types import Outcome
from tools.foreign_readers import READERS, Reader, make_venv, run
from tools.readers.small_set import FPS, LENGTHS, TASKS, episode

CODEC_ERROR = 10
"""of 255, of a frame of AV1 or a JPEG: 7 was seen"""
LEROBOT_3 = READERS["lerobot"]


@dataclass(frozen=True)
class Writer:
    """One library, and what it writes."""

    format: str
    script: str
    venv: Reader
    """whose packages are those that it wants"""


WRITERS = {
    "lerobot-v3.0": Writer("lerobot", "write_small_lerobot.py", LEROBOT_3),
    "lerobot-v2.1": Writer(
        "lerobot",
        "write_small_lerobot.py",
        Reader(
            "lerobot",
            (),
            "",
            (*(each for each in LEROBOT_3.packages if "datasets" not in each), "datasets<=3.6.0"),
            bare=("lerobot==0.3.3", "torchvision==0.28.0"),
        ),
    ),
    "minari": Writer("minari", "write_small_minari.py", READERS["minari"]),
}


def require_small_set(store: EpisodeStore) -> float:
    """Hold what came in of the small data set against what was written.

    Returns the largest error of an image, of 255. Raises AssertionError where anything differs.
    """
    by_place = sorted(map(store.recorded, store.names()), key=lambda each: each.header.info.index)
    assert [each.header.length for each in by_place] == list(LENGTHS)
    worst = 0.0
    for number, recorded in enumerate(by_place):
        wanted, arrays, info = episode(number), recorded.arrays, recorded.header.info
        succeeded = bool(wanted["success"].any())
        assert (recorded.header.outcome is Outcome.SUCCESS) == succeeded, number
        assert info.variant in (TASKS[number], ""), info
        for ours, theirs in (("features", "state"), ("executed", "action"), ("reward", "reward")):
            found = arrays[ours].astype(wanted[theirs].dtype)
            assert found.tobytes() == wanted[theirs].tobytes(), (number, ours)
        if arrays["has_proposed"].any():
            assert np.array_equal(arrays["has_labelled"], wanted["intervention"]), number
        for camera in recorded.header.cameras:
            image = wanted["small" if camera == "small" else "film"]
            error = np.abs(arrays[f"images/{camera}"].astype(int) - image).max()
            assert error <= (0 if camera == "small" else CODEC_ERROR), (number, camera, error)
            worst = max(worst, float(error))
    return worst


def main(arguments: Sequence[str] | None = None) -> int:
    """Run from the command line; the exit code is 1 where what comes in is another."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("directory", type=Path, help="for the venvs")
    parser.add_argument("--writers", nargs="+", choices=WRITERS, default=list(WRITERS))
    parser.add_argument("--keep", type=Path, help="for what is written")
    options = parser.parse_args(arguments)
    failed = 0
    for name in options.writers:
        writer = WRITERS[name]
        with tempfile.TemporaryDirectory() as folder:
            out = Path(folder, f"{name}-v0")
            try:
                python = make_venv(options.directory / name, writer.venv)
                said = run(python, writer.script, out)
                store, source = Path(folder, "store"), f"{writer.format}:{out}"
                import_data(source, store, task="cubes", control_rate_hz=FPS)
                worst = require_small_set(EpisodeStore(store))
                print(f"{said}; the same here, images off by {worst:g} of 255", flush=True)
                if options.keep:
                    shutil.rmtree(out / "images", ignore_errors=True)
                    shutil.copytree(out, options.keep / name)
            except (subprocess.CalledProcessError, AssertionError) as error:
                print(f"{name}: FAILED ({error})", flush=True)
                failed += 1
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
