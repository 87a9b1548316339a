"""The pages that are made: from templates and results, and from the command's types."""

import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import jinja2

from sheath_manip.experiments.takeovers.table import NAMES, wanted
from sheath_manip.learning.flat_plans import upgraded
from tools.docs import numbers
from tools.docs.commands import command_line
from tools.theory_table import means
from tools.theory_table import table as theory_table

ROOT = Path(__file__).resolve().parents[2]
TEMPLATES = Path(__file__).parent / "templates"
NOTE = "<!-- Made by `python -m tools.make_docs` from {source}; change that. -->\n"
NUMBERS = (
    numbers.alike,
    numbers.auroc,
    numbers.best_uninformed,
    numbers.burden_cells,
    numbers.ended,
    numbers.failing_rounds,
    numbers.hits,
    numbers.mean,
    numbers.minutes,
    numbers.more,
    numbers.of_final_variant,
    numbers.percent,
    numbers.rate,
    numbers.takeover_s,
    numbers.takeovers_a_minute,
    numbers.uninformed,
    numbers.with_interval,
    numbers.written,
)


def pages(results: Path = ROOT / "results") -> Iterator[tuple[str, str]]:
    """Yield each page that is made: its path below the checkout, and its text.

    Args:
        results: the experiments' results, a folder with a `summary.json` each, and the benches.
    """
    known = _results(results)
    templates = _environment()
    for path in sorted(TEMPLATES.rglob("*.md")):
        name = path.relative_to(TEMPLATES).as_posix()
        source = f"tools/docs/templates/{name}"
        text = templates.get_template(name).render(known)
        yield ("" if name == "README.md" else "docs/") + name, NOTE.format(source=source) + text
    yield "docs/command-line.md", NOTE.format(source="the verbs of `sheath`") + command_line()


def span(summary: dict[str, Any], term: str, scale: float = 1) -> str:
    """Return least and largest of a term of the theorem over all methods: `63 to 185`.

    A method whose gate judges nothing has no such term.
    """
    found = [means(method)[term] for method in summary["methods"].values()]
    values = [scale * each for each in found if not math.isnan(each)]
    return f"{min(values):.0f} to {max(values):.0f}"


def arm_file(name: str) -> str:
    """Return the text of an arm's file, as assets/robots has it."""
    return (ROOT / "assets" / "robots" / f"{name}.toml").read_text()


def _environment() -> jinja2.Environment:
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(TEMPLATES),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        # The pages are Markdown.
        autoescape=False,
    )
    environment.globals |= {function.__name__: function for function in NUMBERS}
    environment.globals |= {"theory_table": theory_table, "theory_means": means, "span": span}
    environment.globals |= {"arm_file": arm_file}
    environment.globals |= {"takeover_names": NAMES, "takeover_target": wanted}
    return environment


def _results(results: Path) -> dict[str, Any]:
    """Every result by its name in a template: `grasp_clutter`, `outside_fetch`, `bench_data`."""
    files = {
        "-".join(path.parent.relative_to(results).parts): path
        for path in results.glob("**/summary.json")
    }
    files |= {path.stem: path for path in results.glob("*.json")}
    return {
        name.replace("-", "_"): upgraded(json.loads(path.read_text()))
        for name, path in files.items()
    }
