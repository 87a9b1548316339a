"""Inject every kind of fault and count what was survived and told.

    python -m tools.bench_faults [--section NAME ...] [--quick] [--results DIRECTORY]

writes faults.json, {section: {kind: {"tried": n, "survived": n, "told": n}}}, which
docs/reliability.md shows. A section that is not asked for keeps the counts that stand in the file.
Exits with 1 where a case was not survived, or not told of.
"""

import argparse
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from importlib import import_module
from pathlib import Path

from tests.faults.counting import Count

Section = Callable[[bool], Mapping[str, Count]]
"""Runs its cases, all or, where told to be quick, a few of each kind; returns counts by kind."""

SECTIONS = {
    "loop": "tests.faults.loop_section:counts",
    "checkpoints": "tests.faults.checkpoint_section:counts",
    "exchange": "tests.faults.exchange_section:counts",
    "stores": "tests.faults.stores_section:counts",
}
"""by name, `module:callable` of each section: imported only where it is run"""


def section(name: str) -> Section:
    """Return the section of that name."""
    module, _, attribute = SECTIONS[name].partition(":")
    return getattr(import_module(module), attribute)


def table(counts: Mapping[str, Count]) -> str:
    """Return the counts as lines of a Markdown table, the sum last."""
    rows = [("fault", "tried", "survived", "told"), ("---", "---:", "---:", "---:")]
    total = sum(counts.values(), Count())
    rows += [
        (kind, str(count.tried), str(count.survived), str(count.told))
        for kind, count in (*counts.items(), ("**all**", total))
    ]
    return "\n".join(f"| {' | '.join(row)} |" for row in rows)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the sections, print a table each, write faults.json; return the exit code."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--section", nargs="*", choices=tuple(SECTIONS), default=tuple(SECTIONS))
    parser.add_argument("--quick", action="store_true", help="a few of each kind")
    parser.add_argument("--results", type=Path, default=Path("results"), help="directory")
    options = parser.parse_args(arguments)
    path = options.results / "faults.json"
    written = json.loads(path.read_text()) if path.exists() else {}
    clean = True
    for name in options.section:
        counts = section(name)(options.quick)
        clean &= all(count.clean for count in counts.values())
        written[name] = {kind: asdict(count) for kind, count in counts.items()}
        print(f"{name}\n{table(counts)}\n", flush=True)
    options.results.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(written, indent=2) + "\n")
    return 0 if clean else 1


if __name__ == "__main__":
    raise SystemExit(main())
