"""The table of theorem 4.2's terms, and that the document holds the committed numbers."""

import json
from pathlib import Path

import pytest

from tools.theory_table import HEADER, main, table

ROOT = Path(__file__).resolve().parents[2]


def entry(number: int, bound: float, measured: float | None) -> dict:
    terms = {"horizon": 100.0, "epsilon": 0.1, "xi": bound / 100 - 0.1}
    return {"round": number, **terms, "bound": bound, "measured": measured}


SUMMARY = {
    "methods": {
        "dagger": {"rounds": [entry(0, 1.0, 9.0), entry(1, 30.0, 40.0), entry(2, 50.0, 20.0)]},
        "hg-dagger": {"rounds": [entry(0, 1.0, 1.0), entry(1, 30.0, None)]},
    }
}


def test_one_row_a_method_of_its_own_rounds():
    lines = table(SUMMARY).splitlines()
    assert lines[0].count("|") == len(HEADER) + 1
    assert lines[2] == "| dagger | 1–2 | 100.0 | 0.100 | 0.300 | 40.0 | 30.0 | 1 of 2 | 0.100 |"
    assert lines[3] == "| hg-dagger | 1 | – | – | – | – | – | – | – |"


def test_or_one_a_round():
    lines = table(SUMMARY, by_round=True).splitlines()
    assert [line.split(" | ")[-2] for line in lines[2:4]] == ["0 of 1", "1 of 1"]


@pytest.mark.parametrize("task", ["driving", "platformer"])
def test_the_document_holds_the_committed_numbers(task, capsys):
    summary = ROOT / "results" / task / "summary.json"
    if not summary.exists():
        pytest.skip(f"{summary} is not there yet")
    main([str(summary)])
    printed = capsys.readouterr().out
    assert "held in" in printed
    assert json.loads(summary.read_text())["experiment"] == task
    assert printed in (ROOT / "docs" / "theory.md").read_text(), (
        f"docs/theory.md is behind results/{task}; wanted what "
        f"`python -m tools.theory_table results/{task}/summary.json` prints"
    )
