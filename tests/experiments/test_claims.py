"""A claim holds or it does not, and `sheath claims` says which."""

import json
from pathlib import Path

import pytest
from rich.console import Console

from sheath_manip.exceptions import StoreError
from sheath_manip.experiments.claims import Claim, Summary, missing, print_claims, verdicts


def rate(summary: Summary) -> float:
    return summary["rate"]


def bar(summary: Summary) -> float:
    return summary["bar"]


CLAIMS = {"toy": (Claim("a rate", rate, "<=", bar),)}


def summary_in(directory: Path, **content: float) -> Path:
    (directory / "toy").mkdir(parents=True)
    (directory / "toy" / "summary.json").write_text(json.dumps(content))
    return directory


@pytest.mark.parametrize(("value", "code"), [(0.1, 0), (0.3, 1)])
def test_exit_code_says_whether_all_claims_hold(tmp_path: Path, value: float, code: int) -> None:
    found = verdicts(summary_in(tmp_path, rate=value, bar=0.2), CLAIMS)
    assert print_claims(found, Console(quiet=True)) == code


@pytest.mark.parametrize(("value", "code", "word"), [(0.3, 0, "missed"), (0.1, 1, "said to be")])
def test_what_is_known_to_be_missed_is_shown_as_that(tmp_path, value, code, word) -> None:
    claims = {"toy": missing(CLAIMS["toy"], "a rate")}
    console = Console(record=True, width=200)
    found = verdicts(summary_in(tmp_path, rate=value, bar=0.2), claims)
    assert print_claims(found, console) == code
    assert word in console.export_text()


def test_a_bench_line_is_a_claim_too(tmp_path: Path) -> None:
    line = {"value": 12.0, "unit": "times", "goal": ">= 15", "holds": False, "how": "medians"}
    (tmp_path / "bench-gate.json").write_text(json.dumps({"speed": line}))
    assert [verdict.holds for verdict in verdicts(tmp_path, {})] == [False]


@pytest.mark.parametrize("line", [{"goal": ">= 15", "holds": True}, 12.0])
def test_a_bench_line_without_its_numbers_is_named(tmp_path: Path, line) -> None:
    (tmp_path / "bench-gate.json").write_text(json.dumps({"speed": line}))
    with pytest.raises(StoreError, match="no value, goal and holds for 'speed'"):
        verdicts(tmp_path, {})


def test_missing_numbers_and_no_results_are_one_line(tmp_path: Path) -> None:
    with pytest.raises(StoreError, match="run `sheath experiment` first"):
        verdicts(tmp_path, CLAIMS)
    with pytest.raises(StoreError, match="lacks the numbers of 'a rate'"):
        verdicts(summary_in(tmp_path, rate=0.1), CLAIMS)
