"""Which episode runs, and how much of the acting fell to whom so far."""

from html import escape

from sheath_manip.dashboard import palette
from sheath_manip.dashboard.markup import TEXT
from sheath_manip.dashboard.moment import Moment
from sheath_manip.dashboard.part import Desk
from sheath_manip.dashboard.tally import Figures, Share
from sheath_manip.types import Outcome, TaskSpec


class Counts:
    """Episode, step, shares and outcomes."""

    def __init__(self, desk: Desk) -> None:
        self._spec = desk.spec
        self._facts = desk.viser.gui.add_html("")
        self._limited = desk.viser.gui.add_html("", visible=False)
        self._counts = desk.viser.gui.add_html("")

    def draw(self, moment: Moment) -> None:
        """Show the counts so far."""
        figures = moment.figures
        self._facts.content = _facts(figures, self._spec)
        self._counts.content = _counts(figures)
        # The text first: an empty box would be seen for a moment otherwise.
        self._limited.content = _limited(figures)
        self._limited.visible = figures.series.limited_steps > 0


def _facts(figures: Figures, spec: TaskSpec) -> str:
    info = figures.info
    where = (info.method, info.purpose.value, f"round {info.round}", f"episode {info.index}")
    now = f"step {figures.episode.steps} of {spec.max_steps}"
    return (
        f'<div style="{TEXT}">{escape(" · ".join(filter(None, where)))}<br>{now}'
        f'<span style="opacity:.6"> · scene {info.seed}</span></div>'
    )


def _limited(figures: Figures) -> str:
    """What the command filter did to the latest step, and how often it did anything."""
    now = " · ".join(f"{escape(each.limit)} {each.by:.0%}" for each in figures.limited)
    counted = " · ".join(
        f"{share.limited_share:.0%} of {name}"
        for name, share in (("this episode", figures.episode), ("all", figures.series))
    )
    colour = palette.css(palette.LIMITED) if now else "transparent"
    return (
        f'<div style="{TEXT};border-left:4px solid {colour};padding-left:.5em">'
        f"<b>Command limited</b> {now or 'not now'}<br>"
        f'<span style="opacity:.6">{counted}</span></div>'
    )


def _counts(figures: Figures) -> str:
    def row(name: str, share: Share) -> str:
        return (
            f'<tr><td style="opacity:.6;text-align:left">{name}</td><td>{share.interventions}</td>'
            f"<td>{share.expert_share:.0%}</td><td>{share.steps}</td></tr>"
        )

    info = figures.info
    series = " ".join(filter(None, (info.method, info.purpose.value)))
    outcomes = figures.outcomes or {}
    ended = " &nbsp; ".join(
        f'<span style="color:{palette.css(palette.OUTCOME[outcome])}">'
        f"<b>{outcomes.get(outcome, 0)}</b> {escape(outcome.value)}</span>"
        for outcome in Outcome
    )
    return (
        f'<div style="{TEXT}"><table style="width:100%;text-align:right">'
        '<tr style="opacity:.6"><td></td><td>interventions</td><td>expert</td><td>steps</td></tr>'
        f"{row('this episode', figures.episode)}{row(f'all {escape(series)}', figures.series)}"
        f'</table><div style="margin-top:0.3em">{ended}</div></div>'
    )
