"""The wheel, installed by itself: beside the packages of others, far from the checkout."""

import os
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import venv
import zipfile
from pathlib import Path

import pytest

from tests.waiting import DEADLINE_S

ROOT = Path(__file__).parents[2]
SOURCES = ("pyproject.toml", "MANIFEST.in", "README.md", "LICENSE")
PACKAGE = ("sheath_manip", "tasks", "controllers", "assets")
PUBLIC = """
import sheath_manip
from sheath_manip import *
from sheath_manip.rollout.loop import rollout
print(sheath_manip.__file__, *(name for name in sheath_manip.__all__ if name in globals()))
"""


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    """A copy without what earlier builds left behind, which setuptools would pack again."""
    copy = tmp_path / "checkout"
    copy.mkdir()
    for name in SOURCES:
        shutil.copy(ROOT / name, copy)
    for name in PACKAGE:
        shutil.copytree(
            ROOT / name, copy / name, symlinks=True, ignore=shutil.ignore_patterns("__pycache__")
        )
    return copy


def _run(*command: object, cwd: Path, **environment: str) -> str:
    inherited = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    done = subprocess.run(
        [*map(str, command)],
        cwd=cwd,
        env=inherited | environment,
        capture_output=True,
        text=True,
        timeout=DEADLINE_S,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def _pip(*arguments: object, cwd: Path) -> None:
    _run(sys.executable, "-m", "pip", "--disable-pip-version-check", *arguments, cwd=cwd)


def _files_of_the_package() -> set[str]:
    """What a wheel is to hold, links followed."""
    return {
        str(Path(folder, name).relative_to(ROOT))
        for folder, _, names in os.walk(ROOT / "sheath_manip", followlinks=True)
        if "__pycache__" not in folder
        for name in names
    }


def _venv_with_third_parties(place: Path) -> Path:
    """A venv that sees the packages of this one, but no checkout that is installed editable.

    A folder in a .pth file goes onto the path; the .pth files inside it, by which an editable
    checkout is found, are not read.
    """
    venv.create(place, symlinks=True)
    site = Path(sysconfig.get_path("purelib", vars={"base": str(place)}))
    (site / "third_parties.pth").write_text(sysconfig.get_path("purelib"))
    return site


@pytest.mark.timeout(240)
def test_an_installed_wheel_works_far_from_the_checkout(checkout: Path, tmp_path: Path) -> None:
    wheels, place, elsewhere = (tmp_path / name for name in ("wheels", "venv", "elsewhere"))
    elsewhere.mkdir()
    _pip("wheel", checkout, "--no-deps", "--no-build-isolation", "-w", wheels, cwd=tmp_path)
    [wheel] = wheels.glob("*.whl")
    with zipfile.ZipFile(wheel) as archive:
        packed = {name for name in archive.namelist() if ".dist-info/" not in name}
    assert packed == _files_of_the_package()

    site = _venv_with_third_parties(place)
    before = set(site.iterdir())
    into = ("--python", place / "bin" / "python")
    _pip(*into, "install", "--no-deps", "--no-index", wheel, cwd=tmp_path)
    added = sorted(path.name for path in set(site.iterdir()) - before)
    assert added == ["sheath_manip", f"{'-'.join(wheel.name.split('-')[:2])}.dist-info"]

    sheath, python = place / "bin" / "sheath", place / "bin" / "python"
    where, *names = _run(python, "-c", PUBLIC, cwd=elsewhere).split()
    assert where == str(site / "sheath_manip" / "__init__.py")
    assert len(names) > 10
    tasks = _run(sheath, "tasks", cwd=elsewhere)
    assert all(name in tasks for name in ("driving", "gauze-cutting", "platformer", "cnn"))
    _run(sheath, "collect", "driving", "--episodes", 1, "--store", "store", cwd=elsewhere)
    for command in ((sheath,), (python, "-m", "sheath_manip.tasks.driving")):
        assert "success" in _run(*command, "data", "list", "store", cwd=elsewhere)


def test_the_source_archive_holds_the_package_and_no_tests(checkout: Path, tmp_path: Path) -> None:
    build = "from setuptools import build_meta; build_meta.build_sdist('..')"
    _run(sys.executable, "-c", build, cwd=checkout)
    [path] = tmp_path.glob("*.tar.gz")
    with tarfile.open(path) as archive:
        names = [Path(member.name) for member in archive.getmembers() if member.isfile()]
    packed = {str(Path(*name.parts[1:])) for name in names}
    assert {name for name in packed if name.startswith("sheath_manip/")} == _files_of_the_package()
    assert not any(name.startswith(("tests/", "tools/")) for name in packed)
