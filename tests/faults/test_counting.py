"""The tool that counts faults keeps what is not asked for, and fails where a case was not told."""

import json

import pytest

from tests.faults.counting import Count, Verdict, counted
from tools import bench_faults


def test_verdicts_are_counted_by_kind_in_their_order():
    verdicts = [Verdict("b", True, True), Verdict("a", True, False), Verdict("b", False, False)]
    assert counted(verdicts) == {"b": Count(2, 1, 1), "a": Count(1, 1, 0)}
    assert list(counted(verdicts)) == ["b", "a"]


def good(quick: bool):
    return {"kind": Count(1 if quick else 9, 1 if quick else 9, 1 if quick else 9)}


def bad(quick: bool):
    del quick
    return {"kind": Count(3, 2, 3)}


@pytest.fixture
def sections(monkeypatch) -> None:
    table = {"loop": f"{__name__}:good", "files": f"{__name__}:bad"}
    monkeypatch.setattr(bench_faults, "SECTIONS", table)


@pytest.mark.usefixtures("sections")
def test_a_section_that_is_not_asked_for_keeps_its_counts(tmp_path, capsys):
    results = ["--results", str(tmp_path)]
    assert bench_faults.main(["--section", "loop", *results]) == 0
    assert bench_faults.main(["--section", "files", *results]) == 1
    written = json.loads((tmp_path / "faults.json").read_text())
    assert written == {
        "loop": {"kind": {"tried": 9, "survived": 9, "told": 9}},
        "files": {"kind": {"tried": 3, "survived": 2, "told": 3}},
    }
    assert "| **all** | 3 | 2 | 3 |" in capsys.readouterr().out
    assert bench_faults.main(["--quick", "--section", "loop", *results]) == 0
    assert json.loads((tmp_path / "faults.json").read_text())["loop"]["kind"]["tried"] == 1
