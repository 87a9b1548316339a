"""`sheath doctor`: the dependencies that this machine lacks, and how to install them."""

import os
import shutil
import socket
import sys
import time
from dataclasses import dataclass
from importlib import metadata
from importlib.util import find_spec
from pathlib import Path

from packaging.requirements import Requirement
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from sheath_manip.cli.examples import EXAMPLES
from sheath_manip.cli.gl import GL_CURES, GL_LIBRARIES, GL_OFF, gl_in_force, render_time_ms
from sheath_manip.exceptions import SetupError

HOST = "127.0.0.1"
PORT = 8080
"""where the dashboard listens unless told otherwise"""

MIN_FREE_GB = 2.0
"""a full experiment writes some hundred megabytes of episodes and checkpoints"""

SIMULATOR = ("mujoco", "dm_control", "mink", "daqp")
"""what the house's own tasks import beside the core: the extra `tasks`"""

WITH_TASKS = "pip install 'sheath-manip[tasks]'"
INSTALL = f"{WITH_TASKS}, or in a checkout pip install -c constraints.txt -e '.[tasks]'"

NEXT = f"{EXAMPLES['collect']}  (`sheath` alone says how it goes on)"
AFTER_CURE = "cure what is named above, then `sheath doctor` again"

CLASHES = {
    "mujoco": "MuJoCo 4 dropped flex_vertedge, which dm-control 1.0.50 reads",
    "viser": "the access control wraps the websocket server of viser 1.1",
    "zarr": "3.1 is the last minor version for Python 3.11",
}


@dataclass(frozen=True)
class Finding:
    """What one check found."""

    name: str
    ok: bool
    detail: str
    cure: str = ""
    """what to do about it; empty where all is well"""


def report(console: Console) -> int:
    """Print all findings, the problems with their cures, and what to run next.

    0 where there is no problem, else 1.
    """
    with console.status("looking at this machine"):
        findings = examine()
    table = Table(box=None, pad_edge=False)
    for heading in ("", "check", "found"):
        table.add_column(heading)
    for finding in findings:
        mark = "[green]ok[/]" if finding.ok else "[red]problem[/]"
        table.add_row(mark, escape(finding.name), escape(finding.detail))
    console.print(table)
    problems = [finding for finding in findings if not finding.ok]
    for problem in problems:
        # Unwrapped, so that a command can be copied whole.
        console.print(
            f"[bold]{escape(problem.name)}[/]: {escape(problem.cure)}",
            soft_wrap=True,
            highlight=False,
        )
    console.print(f"\nnext: {AFTER_CURE if problems else NEXT}", soft_wrap=True, highlight=False)
    return 1 if problems else 0


def examine() -> list[Finding]:
    """Run all checks; about three seconds, most of them for rendering in processes of their own."""
    return [
        check_python(),
        *check_versions(),
        *check_gl(),
        check_port(),
        check_disk(Path.cwd()),
        check_threads(),
    ]


def check_python() -> Finding:
    """Python 3.11 or newer."""
    found = ".".join(map(str, sys.version_info[:3]))
    ok = sys.version_info >= (3, 11)
    cure = "make clean, then PYTHON=python3.11 make install"
    return Finding("python", ok, f"{found} at {sys.executable}", "" if ok else cure)


def check_versions() -> list[Finding]:
    """Compare what is installed with the ranges that pyproject.toml names.

    Without the simulator of the house's own tasks only the core is looked at.
    """
    missing = _missing_simulator()
    extra = {"extra": "" if missing else "tasks"}
    try:
        requirements = [Requirement(line) for line in metadata.requires("sheath-manip") or ()]
    except metadata.PackageNotFoundError:
        return [Finding("packages", False, "sheath-manip is not installed", INSTALL)]
    requirements = [r for r in requirements if r.marker is None or r.marker.evaluate(extra)]

    problems = []
    for wanted in requirements:
        try:
            version = metadata.version(wanted.name)
        except metadata.PackageNotFoundError:
            problems.append(Finding(wanted.name, False, "not installed", INSTALL))
            continue
        if not wanted.specifier.contains(version, prereleases=True):
            why = f" ({CLASHES[wanted.name]})" if wanted.name in CLASHES else ""
            detail = f"{version} is installed, {wanted.specifier} is wanted{why}"
            problems.append(Finding(wanted.name, False, detail, INSTALL))
    summary = f"{len(requirements)} packages within the ranges of pyproject.toml"
    findings = problems or [Finding("packages", True, summary)]
    if missing:
        detail = f"not installed ({', '.join(missing)} missing); {WITH_TASKS} brings them"
        findings.append(Finding("own tasks", True, detail))
    return findings


def check_gl() -> list[Finding]:
    """Render with the back end in force, and with the others that need no display as spares."""
    in_force = gl_in_force()
    if "mujoco" in _missing_simulator():
        return [Finding("rendering", True, "not looked at: MuJoCo is not installed")]
    if in_force in GL_OFF:
        return [
            Finding("rendering", False, f"MUJOCO_GL={in_force} turns it off", "unset MUJOCO_GL")
        ]
    if in_force not in GL_LIBRARIES:
        detail = f"MUJOCO_GL={in_force} is unknown; known: {', '.join(GL_LIBRARIES)}"
        return [Finding("rendering", False, detail, "unset MUJOCO_GL")]

    result = render_time_ms(in_force)
    spares = {name: render_time_ms(name) for name in ("egl", "osmesa") if name != in_force}
    name = f"rendering, {in_force}"
    if isinstance(result, float):
        setting = os.environ.get("MUJOCO_GL") or "not set"
        finding = Finding(name, True, f"{result:.2f} ms a frame; in force: MUJOCO_GL is {setting}")
    else:
        working = [spare for spare, spare_ms in spares.items() if isinstance(spare_ms, float)]
        cure = f"export MUJOCO_GL={working[0]}" if working else GL_CURES[in_force]
        finding = Finding(name, False, f"in force and does not work: {result}", cure)
    return [
        finding,
        *(
            Finding(
                f"rendering, {spare}",
                True,
                f"{spare_ms:.2f} ms a frame; a spare"
                if isinstance(spare_ms, float)
                else f"not at hand; needed only where {in_force} does not work",
            )
            for spare, spare_ms in spares.items()
        ),
    ]


def check_port(port: int = PORT) -> Finding:
    """Check whether the dashboard's own port is free on the loopback address."""
    if _is_free(port):
        return Finding("port", True, f"{HOST}:{port} is free")
    free = next((other for other in range(port + 1, port + 100) if _is_free(other)), None)
    cure = f"stop what listens on {port}, or give the dashboard another port"
    return Finding(
        "port", False, f"{HOST}:{port} is taken", cure + (f": {free} is free" if free else "")
    )


def _is_free(port: int) -> bool:
    with socket.socket() as probe:
        # As servers do: a port whose last connection is only just closed counts as free.
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((HOST, port))
        except OSError:
            return False
    return True


def check_disk(folder: Path) -> Finding:
    """Free space where results and runs are written."""
    free_gb = shutil.disk_usage(folder).free / 1e9
    ok = free_gb >= MIN_FREE_GB
    cure = f"free {MIN_FREE_GB - free_gb:.1f} GB there, or work in another folder"
    return Finding("disk", ok, f"{free_gb:.1f} GB free in {folder}", "" if ok else cure)


def check_threads() -> Finding:
    """Check whether torch starts no more threads than there are cores; name the CUDA devices."""
    cores = len(os.sched_getaffinity(0)) if sys.platform == "linux" else os.cpu_count() or 1
    start_s = time.perf_counter()
    try:
        # Here and not above: it takes a second, and a broken torch is a finding too.
        import torch
    except (ImportError, OSError) as error:
        return Finding("torch", False, str(error), INSTALL)
    import_s = time.perf_counter() - start_s
    threads = torch.get_num_threads()
    ok = threads <= cores
    devices = [torch.cuda.get_device_name(each) for each in range(torch.cuda.device_count())]
    on = ", ".join(devices) or "no CUDA device"
    detail = f"{threads} threads on {cores} cores, imported in {import_s:.1f} s; {on}"
    return Finding("torch", ok, detail, "" if ok else f"export OMP_NUM_THREADS={cores}")


def require_simulator() -> None:
    """Raise `SetupError` where a package of the extra `tasks` is missing; nothing is imported."""
    missing = _missing_simulator()
    if missing:
        raise SetupError(
            f"the house's own tasks want {', '.join(SIMULATOR)}; missing: {', '.join(missing)}; "
            f"cure: {WITH_TASKS}"
        )


def _missing_simulator() -> list[str]:
    return [package for package in SIMULATOR if find_spec(package) is None]
