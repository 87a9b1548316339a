"""Learning curves: what each round of each method showed so far."""

from collections.abc import Sequence
from dataclasses import dataclass

from sheath_manip.dashboard.chart_numbers import Curve, Form
from sheath_manip.dashboard.line_chart import line_chart
from sheath_manip.dashboard.markup import TEXT, caption, note
from sheath_manip.dashboard.snapshot import Snapshot
from sheath_manip.dashboard.widget import WidgetContext
from sheath_manip.learning.curves import SHARE, Curves
from sheath_manip.learning.pooled import Field
from sheath_manip.learning.results import EXPERT, RoundResult
from sheath_manip.metrics import RATES
from sheath_manip.playback import palette
from sheath_manip.playback.written import capitalised, quantity, shown
from sheath_manip.types import Outcome

CLONED = "cloned policy"
"""that round 0 shows alone: fitted to episodes that the expert drove"""
FIRST = palette.Look(palette.INK, "o")
NO_ROUND = "The curves of sheath learn, or of an experiment, appear here with the first round."
LEGEND = (
    "Bands: 95 % intervals over the episodes of all training seeds. Dots: single seeds. For the "
    "numbers point at a round, or go to a chart with Tab and through its rounds with the arrows."
)
SHARES = Form()
FAILED, SUCCEEDED = RATES[Outcome.FAILURE], RATES[Outcome.SUCCESS]


@dataclass(frozen=True)
class _Chart:
    title: str
    detail: str
    field: Field
    quantity: str
    form: Form = SHARES


class LearningCurves:
    """Curves of learning by round, each method a line with its interval, each seed a dot."""

    def __init__(self, context: WidgetContext) -> None:
        gui = context.viser.gui
        self._note = gui.add_html(note(NO_ROUND))
        self._charts = _charts(context.spec.metric)
        self._drawn = [gui.add_html("", visible=False) for _ in self._charts]
        self._curves = Curves(context.spec.metric)
        self._results: Sequence[RoundResult] = ()

    def draw(self, snapshot: Snapshot) -> None:
        """Show what came since."""
        if snapshot.results is self._results:
            return
        self._results = snapshot.results
        self._curves.take(snapshot.results)
        self._note.content = note(LEGEND if snapshot.results else NO_ROUND)
        for chart, html in zip(self._charts, self._drawn, strict=True):
            drawn = line_chart(chart.title, _lines(self._curves, chart), chart.form)
            title = caption(chart.title, chart.detail)
            html.content = f'{title}<div style="{TEXT}">{drawn}</div>'
            html.visible = bool(drawn)


def _charts(metric: str) -> list[_Chart]:
    name = capitalised(quantity(metric))
    return [
        _Chart("Failed while learning", "share of the round's episodes", "executed", FAILED),
        _Chart("Succeeded while learning", "what did neither is stuck", "executed", SUCCEEDED),
        _Chart(name, "mean, of the policy alone", "policy", metric, Form(False, None)),
        _Chart("Policy alone failed", "share of held-out scenes", "policy", FAILED),
        _Chart("Policy alone succeeded", "share of held-out scenes", "policy", SUCCEEDED),
        _Chart("Expert acted", "share of the round's steps", "executed", SHARE),
    ]


def _lines(curves: Curves, chart: _Chart) -> list[Curve]:
    """The methods' lines, and what all of them begin with: the expert, or what was cloned of it."""
    alone = chart.field == "policy"
    start = curves.line(EXPERT, chart.field, chart.quantity)
    looks = palette.methods(curves.methods)
    lines = [
        Curve(
            shown(name),
            looks[name],
            curves.line(name, chart.field, chart.quantity),
            start if alone else {},
        )
        for name in curves.methods
    ]
    return [*lines, Curve(CLONED if alone else EXPERT, FIRST, start)] if start else lines
