"""Open tables: members of the house and of installed packages, by name."""

import subprocess
import sys
from contextlib import suppress
from pathlib import Path

import pytest

from sheath_manip.dataset.exchange.formats import FORMATS, Format, open_file
from sheath_manip.exceptions import ParameterError, RegistrationError, SetupError, UnknownNameError
from sheath_manip.gates.making import GATES
from sheath_manip.learning.methods import METHODS
from sheath_manip.policies import EMBEDDINGS, POLICIES
from sheath_manip.registry import Registry, working
from sheath_manip.signals import SIGNALS
from sheath_manip.support import SUPPORTS
from sheath_manip.tasks.table import STUDIES, TASKS

TABLES = (FORMATS, GATES, METHODS, EMBEDDINGS, POLICIES, SIGNALS, SUPPORTS, STUDIES, TASKS)
GROUP = "sheath.numbers"


def installed(folder: Path, package: str, **members: str) -> None:
    """Leave what an installer leaves of a package with these entry points."""
    info = folder / f"{package}-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {package}\nVersion: 1.0\n")
    lines = "".join(f"{name} = {target}\n" for name, target in members.items())
    (info / "entry_points.txt").write_text(f"[{GROUP}]\n{lines}")


@pytest.fixture
def numbers(tmp_path, monkeypatch):
    """Make a table of numbers, some of them of packages that are installed in `tmp_path`."""
    monkeypatch.syspath_prepend(str(tmp_path))

    def make() -> Registry[int]:
        return Registry("number", GROUP, {"one": "sys:maxsize"}, of=int)

    return make


@pytest.mark.parametrize("table", TABLES, ids=lambda table: table.kind)
def test_every_member_of_the_house_is_there(table):
    for name in table.own:
        # lerobot, which wants another torch, is no package of the tests.
        with suppress(SetupError):
            assert table[name] is table[name]


def test_a_format_that_is_only_written_says_so(tmp_path):
    with (
        FORMATS.including("ink", Format(lambda *_: None)),
        pytest.raises(ParameterError, match="nothing is read of ink"),
    ):
        open_file("ink", tmp_path)


def test_members_of_packages_are_listed_after_the_houses(numbers, tmp_path):
    installed(tmp_path, "guests", two="sys:hexversion")
    table = numbers()
    assert list(table) == ["one", "two"]
    assert (table["one"], table["two"]) == (sys.maxsize, sys.hexversion)
    assert len(table) == 2
    assert table.get("three") is None


def test_an_unknown_name_lists_the_known_and_the_nearest(numbers):
    with pytest.raises(UnknownNameError, match="unknown number 'on'; known: one; did you mean one"):
        numbers()["on"]


def test_a_broken_member_is_named_with_its_package_and_breaks_no_other(numbers, tmp_path):
    installed(tmp_path, "torn", two="nowhere:x", three="sys:version", four="sys:nothing")
    table = numbers()
    for name in ("two", "three", "four"):
        with pytest.raises(RegistrationError, match="package torn") as caught:
            table[name]
        assert "\n" not in str(caught.value)
    lines: list[str] = []
    assert working(table, lines.append) == {"one": sys.maxsize}
    assert len(lines) == 3


def test_two_of_one_name_are_refused_and_both_named(numbers, tmp_path):
    installed(tmp_path, "guests", one="sys:hexversion", two="sys:hexversion")
    table = numbers()
    with pytest.raises(RegistrationError, match=r"'one'.*sheath-manip.*guests"):
        table["one"]
    assert table["two"] == sys.hexversion


def test_a_member_may_be_there_for_a_while(numbers):
    table = numbers()
    with table.including("seven", 7):
        assert table["seven"] == 7
        with pytest.raises(RegistrationError, match="there already"), table.including("one", 1):
            pass
    assert "seven" not in table


def test_the_tables_import_no_member():
    heavy = ("torch", "sklearn", "mujoco", "dm_control", "zarr")
    code = (
        "import sys; import sheath_manip.gates.config;"
        "import sheath_manip.learning.config, sheath_manip.policies, sheath_manip.support;"
        f"print([name for name in {heavy} if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
