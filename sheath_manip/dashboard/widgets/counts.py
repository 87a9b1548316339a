"""Which episode runs, and who acted how much so far."""

from collections.abc import Callable, Mapping
from html import escape
from math import isnan

from sheath_manip.burden import StepCounts
from sheath_manip.dashboard.changed import set_changed
from sheath_manip.dashboard.markup import TEXT, coloured
from sheath_manip.dashboard.rate_limiter import READ_RATE_HZ, RateLimiter
from sheath_manip.dashboard.snapshot import Snapshot
from sheath_manip.dashboard.widget import WidgetContext
from sheath_manip.metrics import ENDED
from sheath_manip.playback import palette
from sheath_manip.types import EpisodeInfo, Limited, Outcome


class Counts:
    """Episode, step, shares and outcomes."""

    def __init__(self, context: WidgetContext, with_series: bool = True) -> None:
        """`with_series` counts all episodes of the same kind, too, where they are all known."""
        self._with_series = with_series
        self._max_steps = context.spec.max_steps
        self._facts = context.viser.gui.add_html("")
        self._limited = context.viser.gui.add_html("", visible=False)
        self._counts = context.viser.gui.add_html("")
        self._limiter = RateLimiter(READ_RATE_HZ)

    def draw(self, snapshot: Snapshot) -> None:
        """Show the counts so far."""
        episode = snapshot.episode
        series = snapshot.series if self._with_series else None
        if self._limiter.should_draw(snapshot):
            # What is recorded has all its steps.
            most = self._max_steps if self._with_series else len(snapshot.trace)
            set_changed(self._facts, content=_facts(snapshot.info, episode.steps, most))
            set_changed(self._counts, content=_counts(episode, series, snapshot.outcomes))
        # The text first: an empty box would be seen for a moment otherwise.
        now = () if snapshot.step is None else snapshot.step.limited
        set_changed(
            self._limited,
            content=_limited(now, episode, series),
            visible=(series or episode).limited_steps > 0,
        )


def _facts(info: EpisodeInfo, steps: int, most: int) -> str:
    where = (info.method, info.purpose.value, f"round {info.round}", f"episode {info.index}")
    return (
        f'<div style="{TEXT}">{escape(" · ".join(filter(None, where)))}<br>'
        f"step {steps} of {most}"
        f'<span style="opacity:.6"> · scene {info.seed}</span></div>'
    )


def _limited(now: tuple[Limited, ...], episode: StepCounts, series: StepCounts | None) -> str:
    """What the command filter did to the step, and how often it did anything."""
    told = " · ".join(f"{escape(each.limit)} {each.by:.0%}" for each in now)
    counted = " · ".join(
        f"{share.limited_share:.0%} of {name}"
        for name, share in (("this episode", episode), ("all", series))
        if share is not None
    )
    colour = palette.css(palette.LIMITED) if now else "transparent"
    return (
        f'<div style="{TEXT};border-left:4px solid {colour};padding-left:.5em">'
        f"<b>Command limited</b> {told or 'not now'}<br>"
        f'<span style="opacity:.6">{counted}</span></div>'
    )


def _counts(episode: StepCounts, series: StepCounts | None, outcomes: Mapping[Outcome, int]) -> str:
    counted = [episode] if series is None else [episode, series]

    def row(name: str, said: Callable[[StepCounts], object]) -> str:
        cells = "".join(f"<td>{said(counts)}</td>" for counts in counted)
        return f'<tr><td style="opacity:.6;text-align:left">{name}</td>{cells}</tr>'

    # Of one episode alone they stand above.
    steps = "" if series is None else row("steps", lambda counts: counts.steps)
    each = "" if series is None else row("… an episode", _takeovers_an_episode)
    headings = "<td></td><td>this episode</td><td>all of its kind</td>" if series else ""
    ended = " &nbsp; ".join(
        f'<span style="white-space:nowrap">'
        f"{coloured('■', palette.OUTCOME[outcome])} <b>{outcomes.get(outcome, 0)}</b> {word}</span>"
        for outcome, word in ENDED.items()
        if outcome is not Outcome.ERROR or outcomes.get(outcome)
    )
    return (
        f'<div style="{TEXT}"><table style="width:100%;text-align:right;line-height:1.25">'
        f'<tr style="opacity:.6">{headings}</tr>'
        f"{row('takeovers', lambda counts: counts.takeovers)}{each}"
        f"{row('… a minute', lambda counts: _number(counts.takeovers_a_minute))}"
        f"{row('driven by others', _driving)}"
        f"{row('labels', lambda counts: counts.labels)}"
        f'{steps}</table><div style="margin-top:0.3em">{ended}</div></div>'
    )


def _takeovers_an_episode(counts: StepCounts) -> str:
    return _number(counts.takeovers_an_episode)


def _driving(counts: StepCounts) -> str:
    return f"{counts.driving_s:.1f} s ({counts.expert_share:.0%})"


def _number(value: float) -> str:
    return "–" if isnan(value) else f"{value:.1f}"
