"""Kill a recording process again and again, and see what its episode store has lost: nothing, ever.

    python -m tools.kill_recorder --kills 30 --writers 2 --polls 10000

Children record synthetic episodes for ever into one store, each with a process that writes them as
`sheath collect` has. Each is killed with SIGKILL at a random moment, mostly in the middle of a
write, alone or together with the one that writes, while this process looks into the store again and
again. Each look must find all episodes that were there before, and one of them, drawn by chance,
equal to the bit to what was recorded; at the end all of them. Exits with 1 where one is damaged,
torn or gone.
"""

import argparse
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from itertools import count
from pathlib import Path

import numpy as np

from sheath_manip.dataset.check import check
from sheath_manip.dataset.faults import FaultKind
from sheath_manip.dataset.naming import episode_name
from sheath_manip.dataset.steps import recorded_of
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.dataset.writer_process import WriterProcess
from sheath_manip.exceptions import StoreError
from tools.identical import identical
from tools.synthetic import synthetic_episode, synthetic_info

LONGEST_WAIT_S = 0.6
"""Several episodes long, so that kills fall on every part of a write."""
READY = "ready"


@dataclass(frozen=True)
class KillReport:
    """What a store was like after its recorder was killed `kills` times."""

    kills: int
    committed: int
    """episodes in the store at the end"""
    damaged: tuple[str, ...]
    """committed episodes with a fault, or that differ from what was recorded"""
    disappeared: tuple[str, ...]
    """episodes that were committed once and are not there"""
    leftovers: int
    polls: int = 0
    """looks into the store while it was written to"""

    @property
    def lossless(self) -> bool:
        """Whether no committed episode was harmed."""
        return not self.damaged and not self.disappeared

    def __str__(self) -> str:
        return (
            f"{self.kills} kills, {self.committed} committed episodes, "
            f"{len(self.damaged)} damaged, {len(self.disappeared)} disappeared, "
            f"{self.leftovers} leftovers, {self.polls} polls"
        )


def kill_recorder(
    path: Path, kills: int, seed: int = 0, writers: int = 1, polls: int = 0
) -> KillReport:
    """Kill recorders into the store at `path` `kills` times, then look at what they left.

    `writers` of them record at a time, and the store is looked into at least `polls` times.
    """
    rng = np.random.default_rng(seed)
    poller = _Poller(EpisodeStore.create(path), rng)
    for run in range(0, kills, writers):
        runs = range(run, min(run + writers, kills))
        share = polls * (runs.stop) // kills
        poller.committed |= _record_until_killed(path, runs, poller, rng, share)
    poller.look()
    store = poller.store
    names, faults = store.names(), check(store)
    damaged = poller.damaged | {fault.name for fault in faults if fault.damaging}
    damaged |= {name for name in set(names) - damaged if not _as_recorded(store, name)}
    return KillReport(
        kills=kills,
        committed=len(names),
        damaged=tuple(sorted(damaged)),
        disappeared=tuple(sorted(poller.disappeared)),
        leftovers=sum(fault.kind is FaultKind.LEFTOVER for fault in faults),
        polls=poller.polls,
    )


def record_for_ever(path: Path, run: int) -> None:
    """Record until killed, naming each episode on stdout once it is stored.

    Before that it names the process that writes.
    """
    writer = WriterProcess(path)

    def record(index: int) -> str:
        info = synthetic_info(run, index)
        writer.append_arrays(recorded_of(synthetic_episode(info)))
        return episode_name(info)

    # After the first one, when everything is imported.
    first = record(0)
    print(READY, writer.process_id, first, sep="\n", flush=True)
    for index in count(1):
        print(record(index), flush=True)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run from the command line; the exit code is 1 where an episode was harmed."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--kills", type=int, default=30)
    parser.add_argument("--writers", type=int, default=1, help="recorders at a time")
    parser.add_argument("--polls", type=int, default=0, help="looks into the store, at least")
    parser.add_argument("--seed", type=int, default=0, help="of the moments of the kills")
    options = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory() as folder:
        report = kill_recorder(
            Path(folder, "store"), options.kills, options.seed, options.writers, options.polls
        )
    print(report)
    for name in (*report.damaged, *report.disappeared):
        print(name)
    return 0 if report.lossless else 1


class _Poller:
    """Looks into a store, and remembers what it has seen there and what was wrong."""

    def __init__(self, store: EpisodeStore, rng: np.random.Generator) -> None:
        self.store = store
        self.rng = rng
        self.polls = 0
        self.committed: set[str] = set()
        """what was there once, or what a recorder said it had committed"""
        self.damaged: set[str] = set()
        self.disappeared: set[str] = set()

    def look(self) -> None:
        """List the store, and read one of its episodes."""
        names = self.store.names()
        self.polls += 1
        self.disappeared |= self.committed - set(names)
        self.committed |= set(names)
        if names:
            name = names[int(self.rng.integers(len(names)))]
            if not _as_recorded(self.store, name):
                self.damaged.add(name)


def _as_recorded(store: EpisodeStore, name: str) -> bool:
    """Whether the store gives the synthetic episode of that name back, to the bit."""
    try:
        episode = store.read(name)
    except StoreError:
        return False
    recorded = synthetic_episode(synthetic_info(episode.info.run_seed, episode.info.index))
    return episode_name(recorded.info) == name and identical(episode, recorded)


def _record_until_killed(
    path: Path, runs: Sequence[int], poller: _Poller, rng: np.random.Generator, polls: int
) -> set[str]:
    """The episodes that children had reported as committed when they were killed.

    Meanwhile the store is looked into; the children live on until it was looked into `polls` times.
    """
    code = "import sys, pathlib, tools.kill_recorder as k; "
    code += "k.record_for_ever(pathlib.Path(sys.argv[1]), int(sys.argv[2]))"
    with ExitStack() as stack:
        children = [
            stack.enter_context(
                subprocess.Popen(
                    [sys.executable, "-c", code, str(path), str(run)],
                    stdout=subprocess.PIPE,
                    stderr=subprocess.PIPE,
                    text=True,
                    cwd=Path(__file__).parents[1],
                )
            )
            for run in runs
        ]
        try:
            writers = [_writer_of(child) for child in children]
            while poller.polls < polls:
                poller.look()
            for child, writer in zip(children, writers, strict=True):
                end_s = time.monotonic() + float(rng.uniform(0.0, LONGEST_WAIT_S))
                while time.monotonic() < end_s:
                    poller.look()
                if rng.random() < 0.5:
                    os.kill(writer, signal.SIGKILL)
                child.kill()
        finally:
            for child in children:
                child.kill()
        for child in children:
            # It ends when also the process that writes has: that one finishes what it was given.
            if child.stderr is not None:
                child.stderr.read()
        # A line that was cut off by the kill names nothing.
        return {
            line.strip()
            for child in children
            if child.stdout is not None
            for line in child.stdout
            if line.endswith("\n")
        }


def _writer_of(child: subprocess.Popen[str]) -> int:
    """The id of the process that writes for a recording child, which has one when it is ready."""
    ready = child.stdout.readline().strip() if child.stdout is not None else ""
    if child.stdout is None or ready != READY:
        told = child.stderr.read() if child.stderr is not None else ""
        raise RuntimeError(f"a recording child did not start: {told}")
    return int(child.stdout.readline())


if __name__ == "__main__":
    sys.exit(main())
