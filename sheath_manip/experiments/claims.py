"""What is claimed of a result, and whether the committed numbers bear it out."""

import json
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
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
    missed: bool = False
    """whether it was promised and is not kept, and the result's page says so: the bar stays, and is
    shown as missed until a new result keeps it"""


@dataclass(frozen=True)
class Verdict:
    """A claim held against the numbers."""

    source: str
    """the file that the number is from"""
    name: str
    value: float
    goal: str
    holds: bool
    missed: bool = False
    """whether it is known not to hold"""


UNINFORMED = ("random-blocks", "random-takeover")
"""methods that take over at random, with the burden of SHEATH: the first that a result has is the
fairest; one of before there were blocks has its share of the steps alone"""


def uninformed(summary: Summary) -> str:
    """Return the method that takes over at random which SHEATH is held against.

    Raises KeyError where the summary has none.
    """
    for name in UNINFORMED:
        if name in summary["methods"]:
            return name
    raise KeyError(" or ".join(UNINFORMED))


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
    goal_shown = f"{claim.relation} {goal:.4g}"
    return Verdict(source, claim.name, value, goal_shown, holds, claim.missed)


def verdicts(results: Path, claims: Mapping[str, Iterable[Claim]]) -> list[Verdict]:
    """Every claim of every experiment that has a summary under `results`, and every bench line."""
    found = []
    for path in sorted(results.glob("*/summary.json")):
        summary = read_summary(path)
        for claim in claims.get(path.parent.name, ()):
            found.append(judge(claim, summary, str(path)))
    for path in sorted(results.glob("bench-*.json")):
        found += [
            _bench_verdict(name, line, str(path)) for name, line in read_summary(path).items()
        ]
    if not found:
        raise StoreError(f"{results} holds no result with a claim; run `sheath experiment` first")
    return found


def missing(claims: Iterable[Claim], *names: str) -> tuple[Claim, ...]:
    """Return `claims`, of which those of these `names` are known not to be kept."""
    return tuple(replace(each, missed=each.name in names) for each in claims)


def print_claims(found: Iterable[Verdict], console: Console) -> int:
    """Print one line a claim; return 1 where one does not hold, or is not what is said of it."""
    grid = Table("result", "claim", "value", "goal", "holds", box=None)
    broken = False
    for verdict in found:
        value = f"{verdict.value:.4g}"
        goal, mark = Text(verdict.goal), _mark(verdict)
        grid.add_row(Text(verdict.source), Text(verdict.name), value, goal, mark)
        broken |= verdict.holds is verdict.missed
    console.print(grid)
    return int(broken)


def _mark(verdict: Verdict) -> Text:
    if verdict.missed:
        told = "yes, but said to be missed" if verdict.holds else "missed"
        return Text(told, "bold red" if verdict.holds else "yellow")
    return Text("yes", "green") if verdict.holds else Text("NO", "bold red")


def _bench_verdict(name: str, line: Mapping[str, Any], source: str) -> Verdict:
    try:
        return Verdict(source, name, float(line["value"]), str(line["goal"]), bool(line["holds"]))
    except (KeyError, TypeError, ValueError) as error:
        raise StoreError(
            f"{source} has no value, goal and holds for {name!r} ({type(error).__name__} {error}); "
            "run its bench tool again"
        ) from error


def read_summary(path: Path) -> Summary:
    """Return a result as it is written today; raises StoreError where it is none."""
    try:
        return upgraded(json.loads(path.read_text()))
    except (OSError, ValueError, AttributeError) as error:
        raise StoreError(f"{path} is no result ({error}); run its experiment again") from error
