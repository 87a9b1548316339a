"""What a summary says of the draft's theorem 4.2, as a Markdown table.

    python -m tools.theory_table [results/driving/summary.json] [--rounds]

prints one row a method, means over rounds 1 and up, or one row a round. `docs/theory.md` holds such
tables and says what the columns mean.
"""

import argparse
import json
import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

TERMS = ("horizon", "epsilon", "xi", "bound", "measured")
HEADER = ("method", "rounds", "T", "ε_N", "ξ", "T (ε_N + ξ)", "J", "held in", "J/T − ξ")


def table(summary: Mapping[str, Any], by_round: bool = False) -> str:
    """The lines of the table."""
    rows = [HEADER, ("---", *("---:",) * (len(HEADER) - 1))]
    for name, method in summary["methods"].items():
        learning = [entry for entry in method["rounds"] if entry["round"] > 0]
        parts = [[entry] for entry in learning] if by_round else [learning]
        rows += [(name, *_cells(part)) for part in parts]
    return "\n".join(f"| {' | '.join(row)} |" for row in rows)


def means(method: Mapping[str, Any]) -> dict[str, float]:
    """Return a method's means over rounds 1 and up, by term; `inside` is J/T − ξ.

    NaN where no round has them all.
    """
    measured = _measured([entry for entry in method["rounds"] if entry["round"] > 0])
    if not measured:
        return dict.fromkeys((*TERMS, "inside"), math.nan)
    found = {term: float(np.mean([entry[term] for entry in measured])) for term in TERMS}
    return {**found, "inside": _inside(measured)}


def _measured(rounds: Sequence[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    """The rounds that have all terms; where no state was labelled J is unknown."""
    return [entry for entry in rounds if all(entry[term] is not None for term in TERMS)]


def _inside(rounds: Sequence[Mapping[str, Any]]) -> float:
    """The least that the loss inside the support can be, as a share of all steps."""
    rest = [max(entry["measured"] / entry["horizon"] - entry["xi"], 0.0) for entry in rounds]
    return float(np.mean(rest))


def _cells(rounds: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    measured = _measured(rounds)
    numbers = [entry["round"] for entry in rounds]
    yield f"{numbers[0]}" if len(numbers) == 1 else f"{numbers[0]}–{numbers[-1]}"
    if not measured:
        yield from ("–",) * (len(HEADER) - 2)
        return
    means = {term: np.mean([entry[term] for entry in measured]) for term in TERMS}
    yield f"{means['horizon']:.1f}"
    yield f"{means['epsilon']:.3f}"
    yield f"{means['xi']:.3f}"
    yield f"{means['bound']:.1f}"
    yield f"{means['measured']:.1f}"
    held = sum(entry["measured"] <= entry["bound"] for entry in measured)
    yield f"{held} of {len(measured)}"
    yield f"{_inside(measured):.3f}"


def main(arguments: Sequence[str] | None = None) -> None:
    """Read, print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("summary", type=Path, nargs="?", default="results/driving/summary.json")
    parser.add_argument("--rounds", action="store_true", help="one row a round")
    options = parser.parse_args(arguments)
    print(table(json.loads(options.summary.read_text()), options.rounds))


if __name__ == "__main__":
    main()
