"""What is claimed of a result, and whether the committed numbers bear it out."""

import json
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from rich.console import Console
from rich.table import Table
from rich.text import Text

from sheath_manip.exceptions import StoreError
from sheath_manip.learning.flat_plans import upgraded

Summary = Mapping[str, Any]


@dataclass(frozen=True)
class Claim:
    """One number of an experiment's summary and what it was promised to be."""

    name: str
    measure: Callable[[Summary], float]
    """a module's own function, since a task's entry travels to worker processes"""
    relation: Literal["<=", ">=", "<", ">"]
    goal: Callable[[Summary], float]
    """what the value is held against; it may be another number of the same summary"""


@dataclass(frozen=True)
class Verdict:
    """A claim held against the numbers."""

    source: str
    """the file that the number is from"""
    name: str
    value: float
    goal: str
    holds: bool


def constant(value: float, summary: Summary) -> float:
    """A bar that does not depend on the summary."""
    del summary
    return value


def judge(claim: Claim, summary: Summary, source: str) -> Verdict:
    """Hold one claim against a summary; raises StoreError where the summary lacks its numbers."""
    try:
        value, goal = float(claim.measure(summary)), float(claim.goal(summary))
    except (KeyError, IndexError, TypeError, ValueError) as error:
        raise StoreError(
            f"{source} lacks the numbers of {claim.name!r} ({type(error).__name__} {error}); "
            "run its experiment again"
        ) from error
    holds = {
        "<=": value <= goal,
        ">=": value >= goal,
        "<": value < goal,
        ">": value > goal,
    }[claim.relation]
    return Verdict(source, claim.name, value, f"{claim.relation} {goal:.4g}", holds)


COUNTS = ("bench-faults.json", "bench-kills.json")
"""Counts of cases, which have no goal of their own: the tools that write them judge them."""


def verdicts(results: Path, claims: Mapping[str, Iterable[Claim]]) -> list[Verdict]:
    """Every claim of every experiment that has a summary under `results`, and every bench line."""
    found = []
    for path in sorted(results.glob("*/summary.json")):
        summary = _read(path)
        for claim in claims.get(path.parent.name, ()):
            found.append(judge(claim, summary, str(path)))
    for path in sorted(results.glob("bench-*.json")):
        if path.name in COUNTS:
            continue
        found += [_bench_verdict(name, line, str(path)) for name, line in _read(path).items()]
    if not found:
        raise StoreError(f"{results} holds no result with a claim; run `sheath experiment` first")
    return found


def print_claims(found: Iterable[Verdict], console: Console) -> int:
    """Print one line a claim; return 1 where one does not hold."""
    grid = Table("result", "claim", "value", "goal", "holds", box=None)
    broken = 0
    for verdict in found:
        mark = Text("yes", "green") if verdict.holds else Text("NO", "bold red")
        value = f"{verdict.value:.4g}"
        grid.add_row(Text(verdict.source), Text(verdict.name), value, Text(verdict.goal), mark)
        broken += not verdict.holds
    console.print(grid)
    return int(broken > 0)


def _bench_verdict(name: str, line: Mapping[str, Any], source: str) -> Verdict:
    try:
        return Verdict(source, name, float(line["value"]), str(line["goal"]), bool(line["holds"]))
    except (KeyError, TypeError, ValueError) as error:
        raise StoreError(
            f"{source} has no value, goal and holds for {name!r} ({type(error).__name__} {error}); "
            "run its bench tool again"
        ) from error


def _read(path: Path) -> Summary:
    try:
        return upgraded(json.loads(path.read_text()))
    except (OSError, ValueError, AttributeError) as error:
        raise StoreError(f"{path} is no result ({error}); run its experiment again") from error
