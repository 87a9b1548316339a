"""Learning curves: what each round of each method showed so far."""

from collections.abc import Callable, Sequence

import numpy as np

from sheath_manip.dashboard.line_chart import line_chart
from sheath_manip.dashboard.markup import TEXT, caption, note
from sheath_manip.dashboard.snapshot import Snapshot
from sheath_manip.dashboard.widget import WidgetContext
from sheath_manip.learning.results import EXPERT, RoundResult
from sheath_manip.metrics import EpisodeRecord, expert_share, figures_of

CLONED = "cloned policy"
"""that round 0 shows alone: fitted to episodes that the expert drove"""
NO_ROUND = "The curves of sheath learn, or of an experiment, appear here with the first round."


class LearningCurves:
    """Curves of learning by round, each method a line; several training seeds are averaged."""

    def __init__(self, context: WidgetContext) -> None:
        gui = context.viser.gui
        metric = context.spec.metric
        self._note = gui.add_html(note(NO_ROUND))
        self._charts: list[tuple[Callable[[RoundResult], float], float | None, str]] = [
            (lambda result: figures_of(result.executed).failure_rate, 0.0, EXPERT),
            (lambda result: figures_of(result.executed).success_rate, 0.0, EXPERT),
            (lambda result: _mean(result.policy, metric), None, CLONED),
            (lambda result: figures_of(result.policy).failure_rate, 0.0, CLONED),
            (lambda result: figures_of(result.policy).success_rate, 0.0, CLONED),
            (lambda result: expert_share(result.executed), 0.0, EXPERT),
        ]
        self._drawn = []
        for title, detail in (
            ("Failed while learning", "share of the round's episodes"),
            ("Succeeded while learning", "what neither failed nor succeeded is stuck"),
            (metric, "mean, of the new policy alone on held-out scenes"),
            ("Policy alone failed", "share of held-out scenes"),
            ("Policy alone succeeded", "share of held-out scenes"),
            ("Expert acted", "share of the round's steps"),
        ):
            html = gui.add_html("", visible=False)
            self._drawn.append((caption(title, detail), html))
        self._results: Sequence[RoundResult] = ()

    def draw(self, snapshot: Snapshot) -> None:
        """Show what came since."""
        if snapshot.results is self._results:
            return
        self._results = snapshot.results
        self._note.visible = not snapshot.results
        for (value, low, first), (title, html) in zip(self._charts, self._drawn, strict=True):
            chart = _chart(snapshot.results, value, low, first)
            html.content = f'{title}<div style="{TEXT}">{chart}</div>'
            html.visible = bool(chart)


def _chart(
    results: Sequence[RoundResult],
    value: Callable[[RoundResult], float],
    low: float | None,
    first: str,
) -> str:
    """The lines of the methods; the round before all of them is named `first`."""
    lines: dict[str, list[tuple[float, float]]] = {}
    for method in dict.fromkeys(result.method for result in results):
        of_method = [result for result in results if result.method == method]
        rounds = sorted({result.round for result in of_method})
        lines[first if method == EXPERT else method] = [
            (number, float(np.mean([value(r) for r in of_method if r.round == number])))
            for number in rounds
        ]
    return line_chart(lines, low)


def _mean(records: Sequence[EpisodeRecord], metric: str) -> float:
    return figures_of(records).metric.get(metric, float("nan"))
