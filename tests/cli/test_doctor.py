import collections
import io
import os
import shutil
import socket
from importlib import metadata
from pathlib import Path

import pytest
from rich.console import Console

from sheath_manip.cli import doctor

FINE = doctor.Finding("disk", True, "80.0 GB free")
BAD = doctor.Finding("port", False, "127.0.0.1:8080 is taken", "take 8081 [or another]")


def _report(monkeypatch, findings) -> tuple[int, str]:
    monkeypatch.setattr(doctor, "examine", lambda: findings)
    console = Console(file=io.StringIO(), width=80)
    code = doctor.report(console)
    assert isinstance(console.file, io.StringIO)
    return code, console.file.getvalue()


def test_report_without_problems(monkeypatch):
    code, text = _report(monkeypatch, [FINE])
    assert code == 0
    assert "80.0 GB free" in text


def test_report_gives_each_problem_its_cure(monkeypatch):
    code, text = _report(monkeypatch, [FINE, BAD])
    assert code == 1
    assert "port: take 8081 [or another]" in text


def test_every_problem_has_a_cure_on_this_machine():
    findings = doctor.examine()
    assert {"python", "port", "disk", "torch"} <= {finding.name for finding in findings}
    assert [f for f in findings if f.ok == bool(f.cure)] == []


def _with_versions(monkeypatch, **versions: str | None) -> list[doctor.Finding]:
    real = metadata.version

    def version(name: str) -> str:
        found = versions.get(name, real(name))
        if found is None:
            raise metadata.PackageNotFoundError(name)
        return found

    monkeypatch.setattr(metadata, "version", version)
    return doctor.check_versions()


def test_installed_versions_are_in_range():
    assert [f.detail for f in doctor.check_versions() if not f.ok] == []


def test_mujoco_4_clashes_with_dm_control(monkeypatch):
    [finding] = _with_versions(monkeypatch, mujoco="4.0.1")
    assert (finding.name, finding.ok) == ("mujoco", False)
    assert "4.0.1" in finding.detail
    assert "flex_vertedge" in finding.detail
    assert "constraints.txt" in finding.cure


def test_all_clashes_are_named(monkeypatch):
    findings = _with_versions(monkeypatch, zarr="3.2.0", viser="1.2.0", numpy=None)
    assert {f.name: f.ok for f in findings} == {"zarr": False, "viser": False, "numpy": False}
    assert "not installed" in {f.detail for f in findings}


def test_a_local_version_is_in_range(monkeypatch):
    [finding] = _with_versions(monkeypatch, torch="2.13.0+cpu")
    assert finding.ok


def test_the_project_itself_is_not_installed(monkeypatch):
    def requires(name: str):
        raise metadata.PackageNotFoundError(name)

    monkeypatch.setattr(metadata, "requires", requires)
    [finding] = doctor.check_versions()
    assert not finding.ok
    assert "sheath-manip" in finding.detail


def test_a_free_port_is_fine():
    with socket.create_server((doctor.HOST, 0)) as server:
        port = server.getsockname()[1]
    assert doctor.check_port(port).ok


def test_a_taken_port_names_a_free_one():
    with socket.create_server((doctor.HOST, 0)) as server:
        port = server.getsockname()[1]
        finding = doctor.check_port(port)
        assert not finding.ok
        free = int(finding.cure.split()[-3])
        assert free != port
        assert doctor.check_port(free).ok


def test_a_full_disk(monkeypatch, tmp_path: Path):
    usage = collections.namedtuple("usage", "total used free")
    monkeypatch.setattr(shutil, "disk_usage", lambda _: usage(100e9, 99.5e9, 0.5e9))
    finding = doctor.check_disk(tmp_path)
    assert not finding.ok
    assert "1.5 GB" in finding.cure


def test_more_threads_than_cores(monkeypatch):
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: set(), raising=False)
    finding = doctor.check_threads()
    assert not finding.ok
    assert "OMP_NUM_THREADS" in finding.cure


def _rendering(monkeypatch, in_force: str, **results: float | str) -> list[doctor.Finding]:
    monkeypatch.setenv("MUJOCO_GL", in_force)
    monkeypatch.setattr(doctor, "render_time_ms", results.__getitem__)
    return doctor.check_gl()


def test_a_missing_spare_is_no_problem(monkeypatch):
    findings = _rendering(monkeypatch, "egl", egl=0.5, osmesa="no library")
    assert [f.ok for f in findings] == [True, True]


def test_a_working_spare_is_the_cure(monkeypatch):
    finding, spare = _rendering(monkeypatch, "egl", egl="no library", osmesa=0.5)
    assert not finding.ok
    assert spare.ok
    assert "no library" in finding.detail
    assert finding.cure == "export MUJOCO_GL=osmesa"


def test_no_back_end_at_all_names_the_packages(monkeypatch):
    finding, _ = _rendering(monkeypatch, "egl", egl="no library", osmesa="nor this")
    assert not finding.ok
    assert "apt-get install libegl1" in finding.cure


@pytest.mark.parametrize("backend", ["off", "vulkan"])
def test_rendering_off_or_unknown(monkeypatch, backend: str):
    [finding] = _rendering(monkeypatch, backend)
    assert not finding.ok
    assert "unset MUJOCO_GL" in finding.cure
