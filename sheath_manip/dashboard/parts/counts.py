"""Which episode runs, and how much of the acting fell to whom so far."""

from collections.abc import Mapping
from html import escape

from sheath_manip.dashboard import palette
from sheath_manip.dashboard.markup import TEXT
from sheath_manip.dashboard.moment import Moment
from sheath_manip.dashboard.part import Desk
from sheath_manip.dashboard.tally import Share
from sheath_manip.types import EpisodeInfo, Limited, Outcome


class Counts:
    """Episode, step, shares and outcomes."""

    def __init__(self, desk: Desk) -> None:
        self._max_steps = desk.spec.max_steps
        self._facts = desk.viser.gui.add_html("")
        self._limited = desk.viser.gui.add_html("", visible=False)
        self._counts = desk.viser.gui.add_html("")

    def draw(self, moment: Moment) -> None:
        """Show the counts so far."""
        episode, series = moment.episode, moment.series
        self._facts.content = _facts(moment.info, episode.steps, self._max_steps)
        self._counts.content = _counts(moment.info, episode, series, moment.outcomes)
        # The text first: an empty box would be seen for a moment otherwise.
        now = () if moment.step is None else moment.step.limited
        self._limited.content = _limited(now, episode, series)
        self._limited.visible = series.limited_steps > 0


def _facts(info: EpisodeInfo, steps: int, max_steps: int) -> str:
    where = (info.method, info.purpose.value, f"round {info.round}", f"episode {info.index}")
    return (
        f'<div style="{TEXT}">{escape(" · ".join(filter(None, where)))}<br>'
        f"step {steps} of {max_steps}"
        f'<span style="opacity:.6"> · scene {info.seed}</span></div>'
    )


def _limited(now: tuple[Limited, ...], episode: Share, series: Share) -> str:
    """What the command filter did to the step, and how often it did anything."""
    told = " · ".join(f"{escape(each.limit)} {each.by:.0%}" for each in now)
    counted = " · ".join(
        f"{share.limited_share:.0%} of {name}"
        for name, share in (("this episode", episode), ("all", series))
    )
    colour = palette.css(palette.LIMITED) if now else "transparent"
    return (
        f'<div style="{TEXT};border-left:4px solid {colour};padding-left:.5em">'
        f"<b>Command limited</b> {told or 'not now'}<br>"
        f'<span style="opacity:.6">{counted}</span></div>'
    )


def _counts(
    info: EpisodeInfo, episode: Share, series: Share, outcomes: Mapping[Outcome, int]
) -> str:
    def row(name: str, of_episode: object, of_series: object) -> str:
        return (
            f'<tr><td style="opacity:.6;text-align:left">{name}</td>'
            f"<td>{of_episode}</td><td>{of_series}</td></tr>"
        )

    every = escape(" ".join(filter(None, (info.method, info.purpose.value))))
    ended = " &nbsp; ".join(
        f'<span style="color:{palette.css(palette.OUTCOME[outcome])}">'
        f"<b>{outcomes.get(outcome, 0)}</b> {escape(outcome.value)}</span>"
        for outcome in Outcome
    )
    return (
        f'<div style="{TEXT}"><table style="width:100%;text-align:right">'
        f'<tr style="opacity:.6"><td></td><td>this episode</td><td>all {every}</td></tr>'
        f"{row('expert acted', f'{episode.expert_share:.0%}', f'{series.expert_share:.0%}')}"
        f"{row('interventions', episode.interventions, series.interventions)}"
        f"{row('switches', episode.switches, series.switches)}"
        f"{row('labels', episode.queries, series.queries)}"
        f"{row('steps', episode.steps, series.steps)}"
        f'</table><div style="margin-top:0.3em">{ended}</div></div>'
    )
