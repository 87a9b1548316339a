"""Kill runs of every verb at random moments, run them again, and compare with one left alone.

    python -m tools.kill_runs [--kills 100] [--task platformer] [--verbs collect run ...]

Each verb is run once to the end. Then it is begun anew in another directory, and killed there at a
random moment up to four times: the run itself by KILL, TERM or INT, its process that writes, or one
of its workers, by KILL. At last it is run to its end, and must have left what the first one did, to
the byte: all arrays and headers, all checkpoints, all results but the time they took. Prints what
became of them and writes kills.json; exits with 1 where a run differs, hangs or prints a
traceback.

Runs are forked from this process, in which everything is imported: a kill then falls on what a run
does and not on its imports, and costs a second and not ten.
"""

import argparse
import hashlib
import json
import os
import signal
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from sheath_manip.cli.entry import INTERRUPTED, OK, run_command
from sheath_manip.cli.session import Catalog, LoadCatalog
from sheath_manip.dataset.check import check
from sheath_manip.dataset.content import is_same
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.rollout.threads import one_thread_by_default

VERBS: Mapping[str, tuple[str, ...]] = {
    "collect": ("--episodes", "3", "--store", "{at}/store"),
    "collect, two workers": ("--episodes", "3", "--store", "{at}/store", "--workers", "2"),
    "run": ("--episodes", "3", "--store", "{at}/store", "--checkpoint", "{checkpoint}"),
    "learn": ("--runs", "{at}", "--plan", "quick"),
    "experiment": ("--runs", "{at}", "--quick"),
}
"""by what is killed: the verb, up to a comma, and its arguments"""
KILLS_PER_RUN = 4
LONGEST_S = 600.0
"""that a run takes to end, by itself or after one of its processes was killed"""
CATALOG = "sheath_manip.command:load_catalog"


@dataclass(frozen=True)
class Kills:
    """What became of the runs of one verb."""

    kills: int = 0
    by_victim: Mapping[str, int] | None = None
    runs: int = 0
    """begun anew, killed, and run to the end"""
    same: int = 0
    """that left what the one did that nothing killed"""
    hangs: int = 0
    tracebacks: int = 0
    leftovers: int = 0
    """files and folders of recordings that were cut off, all of them named as such"""

    @property
    def lossless(self) -> bool:
        """Whether nothing went wrong."""
        return self.same == self.runs and not self.hangs and not self.tracebacks


class Killer:
    """Runs verbs of one task, and kills them."""

    def __init__(self, catalog: LoadCatalog, task: str, folder: Path, seed: int) -> None:
        """Store what is run where; `seed` is that of the moments."""
        self._catalog = catalog
        self._task = task
        self._folder = folder
        self._rng = np.random.default_rng(seed)
        self._checkpoint = folder / "checkpoint.npz"
        self._lasts_s = 0.0
        """of a run that nothing kills, the last that did not: the machine may have other work"""

    def kill(self, what: str, kills: int) -> Kills:
        """Kill runs of one verb so many times."""
        if what.startswith("run") and not self._checkpoint.exists():
            self._train()
        whole = self._folder / f"{what}-whole"
        began_s = time.monotonic()
        self._finished(what, whole)
        self._lasts_s = time.monotonic() - began_s
        found, number = Kills(by_victim={}), 0
        while found.kills < kills:
            at = self._folder / f"{what}-{number}"
            number += 1
            for _ in range(min(KILLS_PER_RUN, kills - found.kills)):
                victim, found = self._killed(what, at, found)
                if not victim:
                    break
                counts = dict(found.by_victim or {})
                counts[victim] = counts.get(victim, 0) + 1
                found = replace(found, kills=found.kills + 1, by_victim=counts)
            self._finished(what, at)
            found = replace(
                found,
                runs=found.runs + 1,
                same=found.same + are_same(whole, at),
                leftovers=found.leftovers + sum(1 for _ in at.rglob("*.tmp*")),
            )
        return found

    def _train(self) -> None:
        store = self._folder / "demonstrations"
        line = ("collect", self._task, "--episodes", "4", "--store", str(store))
        self._ended(self._begun(line, store.with_suffix(".txt")))
        line = ("train", self._task, "--store", str(store), "--calibration", "3")
        line = (*line, "--checkpoint", str(self._checkpoint))
        self._ended(self._begun(line, store.with_suffix(".txt")))

    def _line(self, what: str, at: Path) -> tuple[str, ...]:
        words = (word.format(at=at, checkpoint=self._checkpoint) for word in VERBS[what])
        return (what.partition(",")[0], self._task, *words)

    def _finished(self, what: str, at: Path) -> None:
        """Run to the end; RuntimeError where that does not go well."""
        out = at.with_suffix(".txt")
        code = self._ended(self._begun(self._line(what, at), out))
        if code != OK:
            raise RuntimeError(f"{what} ended with {code}: {out.read_text()[-2000:]}")

    def _killed(self, what: str, at: Path, found: Kills) -> tuple[str, Kills]:
        """Begin, and kill at a random moment; return who was killed, or nothing if all was done."""
        out, is_new = at.with_suffix(".txt"), not at.exists()
        process = self._begun(self._line(what, at), out)
        began_s = time.monotonic()
        ends_s = began_s + float(self._rng.uniform(0, self._lasts_s))
        while time.monotonic() < ends_s:
            if os.waitpid(process, os.WNOHANG) != (0, 0):
                if is_new:
                    self._lasts_s = time.monotonic() - began_s
                return "", found
            time.sleep(0.01)
        victim, sign = str(self._rng.choice(["run", "writer", "worker"], p=[0.6, 0.25, 0.15])), 0
        others = {who: pids for who, pids in _below(process).items() if pids}
        if victim in others:
            os.kill(int(self._rng.choice(others[victim])), signal.SIGKILL)
        else:
            victim = "run"
            sign = int(self._rng.choice([signal.SIGKILL, signal.SIGTERM, signal.SIGINT]))
            os.kill(process, sign)
        code = self._ended(process)
        text = out.read_text()
        # It may come when all is done.
        heard = code in (INTERRUPTED, -signal.SIGINT, OK)
        if "Traceback" in text or (sign == signal.SIGINT and not heard):
            print(f"{what}, {victim} killed by {sign or 9}: {code} {text[-3000:]}", flush=True)
            found = replace(found, tracebacks=found.tracebacks + 1)
        if code is None:
            found = replace(found, hangs=found.hangs + 1)
        name = f"{victim}, {signal.Signals(sign).name}" if sign else f"{victim}, SIGKILL"
        return name, found

    def _begun(self, line: Sequence[str], out: Path) -> int:
        """Fork a run of the command; its output goes into a file."""
        process = os.fork()
        if process:
            return process
        code = 1
        try:
            signal.signal(signal.SIGINT, signal.default_int_handler)
            descriptor = os.open(out, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
            os.dup2(descriptor, 1)
            os.dup2(descriptor, 2)
            code = run_command(self._catalog, list(line))
            sys.stdout.flush()
        except KeyboardInterrupt:
            # Before the command could take it.
            code = INTERRUPTED
        except BaseException as error:
            os.write(2, f"Traceback: {error!r}".encode())
        finally:
            os._exit(code)

    def _ended(self, process: int) -> int | None:
        """The exit code, minus the signal where one ended it; None where it had to be killed."""
        ends_s = time.monotonic() + LONGEST_S
        while time.monotonic() < ends_s:
            ended, status = os.waitpid(process, os.WNOHANG)
            if ended:
                return os.waitstatus_to_exitcode(status)
            time.sleep(0.01)
        os.kill(process, signal.SIGKILL)
        os.waitpid(process, 0)
        return None


def are_same(whole: Path, other: Path) -> bool:
    """Return whether two runs left the same: stores, checkpoints and results, to the byte."""
    stores = [EpisodeStore(at / "store") for at in (whole, other)]
    names = [store.names() for store in stores]
    episodes = names[0] == names[1] and all(
        is_same(stores[0].header(name), stores[1].header(name)) for name in names[0]
    )
    sound = not [fault for fault in check(stores[1]) if fault.damaging]
    return episodes and sound and _files(whole) == _files(other)


def _files(at: Path) -> dict[str, Any]:
    """What lies beside the store: digests of checkpoints, and results but for their times."""
    found: dict[str, Any] = {}
    for path in sorted(at.rglob("*.npz")):
        found[str(path.relative_to(at))] = hashlib.sha256(path.read_bytes()).hexdigest()
    for path in sorted(at.rglob("round-*.json")):
        found[str(path.relative_to(at))] = json.loads(path.read_text()) | {"wall_s": None}
    return found


def _below(process: int) -> dict[str, list[int]]:
    """The processes of a run that write, and those that work for it."""
    parents = {}
    for status in Path("/proc").glob("[0-9]*/stat"):
        try:
            # proc(5): the 2nd field, in brackets, may hold anything; the parent is the 4th.
            parents[int(status.parent.name)] = int(status.read_text().rpartition(")")[2].split()[1])
        except (OSError, IndexError):
            continue
    found: dict[str, list[int]] = {"writer": [], "worker": []}
    for child, parent in parents.items():
        if parent != process:
            continue
        try:
            line = Path(f"/proc/{child}/cmdline").read_bytes()
        except OSError:
            continue
        if b"writer_process" in line:
            found["writer"].append(child)
        elif b"spawn_main" in line:
            found["worker"].append(child)
    return found


def main(arguments: Sequence[str] | None = None) -> int:
    """Run from the command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--kills", type=int, default=100, help="of all verbs together")
    parser.add_argument("--task", default="platformer", help="task that is run")
    parser.add_argument("--verbs", nargs="*", choices=tuple(VERBS), default=tuple(VERBS))
    parser.add_argument(
        "--catalog", default=CATALOG, help="module:name of the tasks, or of what gives them"
    )
    parser.add_argument("--seed", type=int, default=0, help="of the moments of the kills")
    parser.add_argument("--results", type=Path, default=Path("results"), help="directory")
    options = parser.parse_args(arguments)
    module, _, attribute = options.catalog.partition(":")
    tasks: Any = getattr(import_module(module), attribute)
    load: LoadCatalog = (lambda: tasks) if isinstance(tasks, Catalog) else tasks
    one_thread_by_default()
    # What each run would import.
    load()
    import_module("sheath_manip.learning.run")
    path = options.results / "kills.json"
    written = json.loads(path.read_text()) if path.exists() else {}
    lossless = True
    options.results.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        killer = Killer(load, options.task, Path(folder), options.seed)
        for place, what in enumerate(options.verbs):
            share = options.kills * (place + 1) // len(options.verbs)
            share -= options.kills * place // len(options.verbs)
            found = killer.kill(what, share)
            lossless &= found.lossless
            print(f"{what}: {json.dumps(asdict(found))}", flush=True)
            # Other tasks and verbs keep what stands there.
            written.setdefault(options.task, {})[what] = asdict(found)
            path.write_text(json.dumps(written, indent=2) + "\n")
    return 0 if lossless else 1


if __name__ == "__main__":
    sys.exit(main())
