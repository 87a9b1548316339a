"""Figures of results that are there already: from their summaries, without an episode."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from sheath_manip.exceptions import StoreError
from sheath_manip.experiments.claims import read_summary
from sheath_manip.experiments.figures import OF_SUMMARIES
from sheath_manip.experiments.gates.figures import draw as draw_gates
from sheath_manip.experiments.nu.figure import draw as draw_nu

Draw = Callable[[Mapping[str, Any], Path], list[Path]]

BENCHMARKS: Mapping[str, Draw] = {"gates": draw_gates, "nu": draw_nu}
"""by the name of their experiment"""


def redraw(results: Path) -> list[Path]:
    """Draw again what a summary alone can give, of each experiment in `results`; give the paths.

    Figures that need episodes are left as they are: the experiment itself draws them. Raises
    StoreError where there is no summary.
    """
    summaries = sorted(results.glob("*/summary.json"))
    if not summaries:
        raise StoreError(f"{results} holds no */summary.json; run `sheath experiment` first")
    written = []
    for path in summaries:
        summary = read_summary(path)
        try:
            draw = BENCHMARKS.get(summary["experiment"], _draw_learning)
            written += draw(summary, path.parent)
        except (KeyError, IndexError, TypeError, ValueError) as error:
            raise StoreError(
                f"{path} lacks what its figures show ({type(error).__name__} {error}); "
                "run its experiment again"
            ) from error
    return written


def _draw_learning(summary: Mapping[str, Any], directory: Path) -> list[Path]:
    for name, draw in OF_SUMMARIES.items():
        draw(summary, directory / name)
    return [directory / name for name in OF_SUMMARIES]
