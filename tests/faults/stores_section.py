"""The section `stores` of the counts: harmed stores, and what all that reads a store makes of them.

    python -m tests.faults.stores_section COUNT SEED

prints the verdicts on so many as JSON: `counts` starts it as a process of its own, from which each
trial is forked, so that a trial costs no imports and its memory is its own.
"""

import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np

from sheath_manip.dataset.marks import Marks
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.types import Limited, Outcome
from tests.dataset.folders import as_folders, repack
from tests.faults.counting import Count, Verdict, counted
from tests.faults.store_damages import DAMAGES
from tests.faults.store_trial import Original, tried
from tools.synthetic import synthetic_episode, synthetic_info

QUICK, ALL = len(DAMAGES), 20 * len(DAMAGES)
FORGED = ("hostile values, digest made anew", "sizes beyond any memory")
"""With right digests another value is as good as the recorded one."""


def counts(quick: bool) -> Mapping[str, Count]:
    """Return the counts by kind of fault."""
    return counted(verdicts(QUICK if quick else ALL, 0))


def verdicts(count: int, seed: int) -> list[Verdict]:
    """Return what became of `count` harmed stores, of each kind about as many."""
    command = [sys.executable, "-m", "tests.faults.stores_section", str(count), str(seed)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"the trials did not end: {done.stderr}")
    return [Verdict(**each) for each in json.loads(done.stdout)]


def _run(count: int, seed: int, folder: Path) -> Iterator[Verdict]:
    sound, originals = _sound(folder / "sound")
    shutil.copytree(sound.path, folder / "outside")
    outside = _listed(folder / "outside")
    for number in range(count):
        kind, damage = list(DAMAGES.items())[number % len(DAMAGES)]
        store, out = folder / "store", folder / "out"
        shutil.copytree(sound.path, store)
        out.mkdir()
        damage(store, np.random.default_rng([seed, number]))
        if number % 2:
            repack(store)
        trial = tried(store, originals, out, kind in FORGED)
        if _listed(folder / "outside") != outside:
            trial.trouble = "what lies outside was changed"
        shutil.rmtree(store)
        shutil.rmtree(out)
        told = trial.told or trial.harmless
        case = f"{number}: {trial.trouble or 'survived'}, {trial.peak_bytes / 1e6:.0f} MB"
        yield Verdict(kind, survived=not trial.trouble, told=told, case=case)


def _sound(path: Path) -> tuple[EpisodeStore, Mapping[str, Original]]:
    """Three episodes with every kind of array, one longer than a chunk, and marks of one."""
    store = EpisodeStore.create(path)
    originals = {}
    for index, length in enumerate((70, 70, 5)):
        episode = synthetic_episode(synthetic_info(3, index), length, pixels=4)
        first, *others = episode.steps
        limited = (Limited("joint velocity", 0.25),)
        steps = replace(first, labelled=first.executed, limited=limited), *others
        episode = replace(episode, steps=steps)
        marks = Marks(Outcome.SUCCESS, ((0, 2),)) if index == 1 else Marks()
        name = store.append(episode)
        store.mark(name, marks)
        originals[name] = Original(episode, marks)
    # Harm is done to files, and then half of the stores are made of archives again.
    as_folders(path)
    return store, originals


def _listed(folder: Path) -> dict[str, int]:
    entries = folder.rglob("*")
    return {str(entry): entry.lstat().st_mtime_ns for entry in entries}


def _main() -> None:
    count, seed = map(int, sys.argv[1:])
    # In memory where there is such a disk: nothing is tried here of what a slow one does.
    shared = Path("/dev/shm")
    where = shared if os.access(shared, os.W_OK) else None
    with tempfile.TemporaryDirectory(dir=where) as folder:
        print(json.dumps([asdict(verdict) for verdict in _run(count, seed, Path(folder))]))


if __name__ == "__main__":
    _main()
