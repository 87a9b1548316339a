"""What becomes of a harmed store in the hands of all that reads one, in a process of its own.

A trial is survived where every reader either gives what was recorded, to the bit, or says in one
line what is wrong; within `LONGEST_CPU_S` and `MOST_BYTES`, and never looks at what lies outside.
"""

import json
import os
import resource
import select
import signal
import traceback
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from io import StringIO
from pathlib import Path
from typing import Any

from rich.console import Console

from sheath_manip.dataset.card import card
from sheath_manip.dataset.exchange.exporting import export
from sheath_manip.dataset.exchange.selection import Selection
from sheath_manip.dataset.mapped import mapped_samples
from sheath_manip.dataset.marks import Marks
from sheath_manip.dataset.merging import merge, split
from sheath_manip.dataset.repair import repair
from sheath_manip.dataset.show import print_show
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.dataset.table import print_check, print_list
from sheath_manip.exceptions import SheathError
from sheath_manip.seeding import generator
from sheath_manip.types import Episode
from sheath_manip.types.samples import samples_from
from tools.identical import identical

LONGEST_CPU_S, LONGEST_S = 30, 300.0
"""of all readers together, one after the other: who reads, and who waits beside other processes"""
MOST_BYTES = 1536 << 20
"""more than before: a block of images as they are stored, as they are, and in their array"""


@dataclass(frozen=True, eq=False)
class Original:
    """An episode as it was recorded, and what a person said of it."""

    episode: Episode
    marks: Marks


@dataclass
class Trial:
    """What was seen."""

    trouble: str = ""
    """what was not survived"""
    told: bool = False
    harmless: bool = False
    """nothing of what was recorded is another or gone"""
    peak_bytes: int = 0


Reader = Callable[[Path, Path], Any]
READERS: Mapping[str, Reader] = {
    "list": lambda store, _: print_list(str(store), _quiet()),
    "show": lambda store, _: print_show(str(store), "1", _quiet()),
    "card": lambda store, _: card(EpisodeStore(store), None, "MIT"),
    "infos": lambda store, _: EpisodeStore(store).infos(),
    "samples": lambda store, _: samples_from(EpisodeStore(store).episodes()),
    "mapped": lambda store, out: mapped_samples(
        EpisodeStore(store), EpisodeStore(store).names(), out / "cache"
    ),
    "export": lambda store, out: export(
        EpisodeStore(store), out / "x.zarr", "replay-buffer", Selection()
    ),
    "split": lambda store, out: split(
        EpisodeStore(store), {"all": 1.0}, out / "split", generator("split", 0)
    ),
    "merge": lambda store, out: merge([EpisodeStore(store)], EpisodeStore.create(out / "merged")),
    # The last: it changes the store.
    "repair": lambda store, _: repair(EpisodeStore(store), 0.0),
}


def tried(store: Path, originals: Mapping[str, Original], out: Path, forged: bool) -> Trial:
    """Let everything read the harmed `store`; where `forged`, its digests were made anew."""
    reading, writing = os.pipe()
    child = os.fork()
    if not child:
        os.close(reading)
        trial = Trial()
        try:
            _look(store, originals, out, forged, trial)
        except BaseException:
            trial.trouble = f"traceback: {traceback.format_exc(limit=-3)}"
        os.write(writing, json.dumps(asdict(trial)).encode())
        os._exit(0)
    os.close(writing)
    said = b""
    with os.fdopen(reading, "rb") as pipe:
        if select.select([pipe], [], [], LONGEST_S)[0]:
            said = pipe.read()
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    return (
        Trial(**json.loads(said))
        if said
        else Trial(f"did not end within {LONGEST_CPU_S} s of CPU time")
    )


def _look(
    store: Path, originals: Mapping[str, Original], out: Path, forged: bool, trial: Trial
) -> None:
    resource.setrlimit(resource.RLIMIT_CPU, (LONGEST_CPU_S, LONGEST_CPU_S))
    # The peak of memory begins anew, proc(5).
    Path("/proc/self/clear_refs").write_text("5")
    before = _peak_bytes()
    console = _quiet()
    clean = _heard(trial, lambda: print_check(str(store), console)) == 0
    assert isinstance(console.file, StringIO)
    # Of an episode without digests it is said that changes are not found.
    undigested = "have no digest" in console.file.getvalue()
    trial.told = trial.told or not clean or undigested
    trial.harmless = _unchanged(trial, store, originals, forged)
    for name, read in READERS.items():
        lines = _heard(trial, lambda read=read: read(store, out))
        if lines is None and clean and not undigested and trial.harmless and name != "show":
            trial.trouble = trial.trouble or f"{name} refuses what `check` finds sound"
    for part in (out / "merged", out / "split/all"):
        if part.exists():
            _unchanged(trial, part, originals, forged)
            if any(path.is_symlink() for path in part.rglob("*")):
                trial.trouble = "a link was copied"
    if not trial.told and not trial.harmless:
        trial.trouble = trial.trouble or "something is another, and nobody says so"
    trial.peak_bytes = _peak_bytes() - before
    if trial.peak_bytes > MOST_BYTES:
        trial.trouble = trial.trouble or f"took {trial.peak_bytes / 1e6:.0f} MB"


def _heard(trial: Trial, call: Callable[[], Any]) -> Any:
    """What `call` returns; None where it says in a line why not, as the command would."""
    try:
        return call()
    except (SheathError, OSError):
        trial.told = True
        return None


def _unchanged(trial: Trial, path: Path, originals: Mapping[str, Original], forged: bool) -> bool:
    """Whether all originals are there as they were; trouble where one is not and nobody says so."""
    store = _heard(trial, lambda: EpisodeStore(path))
    if store is None:
        return False
    same = store.names() == sorted(originals)
    for name in store.names():
        header = _heard(trial, lambda name=name: store.header(name))
        episode = _heard(trial, lambda name=name: store.read(name))
        marks = _heard(trial, lambda name=name: store.marks(name))
        original = originals.get(name)
        is_same = original is not None and episode is not None
        if original is not None and episode is not None:
            is_same = identical(episode, original.episode)
        said = forged or (header is not None and header.digests is None)
        if episode is not None and not is_same and not said:
            trial.trouble = trial.trouble or f"{name} is read as another than was recorded"
        same = same and is_same and original is not None and marks == original.marks
    return same


def _quiet() -> Console:
    return Console(file=StringIO(), width=400)


def _peak_bytes() -> int:
    status = Path("/proc/self/status").read_text()
    return 1024 * int(status.partition("VmHWM:")[2].split()[0])
