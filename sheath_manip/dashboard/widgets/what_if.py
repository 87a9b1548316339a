"""A dial of the gate: what another threshold would come to, and then to apply it."""

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from html import escape

import numpy as np
import viser

from sheath_manip.dashboard.changed import set_changed
from sheath_manip.dashboard.markup import GREY_BUTTON, TEXT, caption, coloured, note
from sheath_manip.dashboard.snapshot import Snapshot
from sheath_manip.dashboard.widget import WidgetContext
from sheath_manip.gates.adjustable import Boundary, Dial, span_of
from sheath_manip.gates.fitted import FittedGate
from sheath_manip.gates.what_if import Preview, ScoredEpisode, TurnRule, preview
from sheath_manip.playback import palette
from sheath_manip.types import Actor, Outcome

LEAST_STEPS = 100
MOST_TURN_S, MOST_A_MINUTE = 10.0, 20
AGAIN_S = 1.0
"""between two previews where only the episode has gone on"""
NO_SCORE = "A preview needs recorded scores: no gate has judged a step here yet."
ESTIMATE = (
    "From recorded scores; after the first step that would have gone otherwise it is an estimate."
)
ASKED, CALM = palette.ACTOR[Actor.EXPERT], "#80808050"
FAILED = palette.OUTCOME[Outcome.FAILURE]


@dataclass(frozen=True)
class _Present:
    """What a recorded gate went by: a boundary without a judge."""

    threshold: float
    lowest: float
    highest: float
    minimum_hold_steps: int | None = None


class WhatIf:
    """Sliders move a preview alone; the gate goes by it once it is applied."""

    def __init__(
        self, context: WidgetContext, dial: Dial | None = None, fitted: FittedGate | None = None
    ) -> None:
        """`dial` is of a gate that runs; else there is a preview alone, of the gate `fitted`."""
        gui = context.viser.gui
        self._dial, self._fitted = dial, fitted
        self._rate_hz = context.spec.control_rate_hz
        self._boundary: Boundary | _Present | None = None
        self._drawn: object = None
        self._drawn_s = -math.inf
        gui.add_html(caption("What if", "a preview, which moves nothing before it is applied"))
        self.threshold = gui.add_slider("Threshold", min=-1.0, max=1.0, step=0.01, initial_value=0)
        self.turn = gui.add_slider(
            "Shortest turn (s)",
            min=0.0,
            max=MOST_TURN_S,
            step=1 / self._rate_hz,
            initial_value=0.0,
        )
        self.a_minute = gui.add_slider(
            "Requests a minute at most",
            min=0,
            max=MOST_A_MINUTE,
            step=1,
            initial_value=0,
            hint="0: no limit",
        )
        self.apply = gui.add_button("Apply", color="green", visible=dial is not None)
        self.back = gui.add_button("Back to what is now", color=GREY_BUTTON)
        self._table = gui.add_html(note(NO_SCORE))
        wake: Callable[[], None] = context.wake
        self._controls = (self.threshold, self.turn, self.a_minute, self.back)
        for slider in (self.threshold, self.turn, self.a_minute):

            @slider.on_update
            async def _(event: viser.GuiEvent) -> None:
                # An update without a client is the program's own.
                if event.client_id is not None:
                    wake()

        @self.apply.on_click
        async def _(event: viser.GuiEvent) -> None:
            if dial is not None and context.allows(event.client_id):
                wanted = self._wanted
                boundary = dial.boundary.at(wanted.threshold)
                dial.boundary = replace(boundary, minimum_hold_steps=wanted.minimum_hold_steps)
            wake()

        @self.back.on_click
        async def _(_: viser.GuiEvent) -> None:
            self._boundary = None
            wake()

    def draw(self, snapshot: Snapshot) -> None:
        """Tell what is, and what would be."""
        episodes = _with_present(snapshot)
        boundary = self._now(snapshot, episodes)
        for each in self._controls:
            set_changed(each, visible=boundary is not None)
        set_changed(self.apply, visible=self._dial is not None and boundary is not None)
        if boundary is None:
            set_changed(self._table, content=note(NO_SCORE))
            return
        if boundary is not self._boundary:
            self._begin_at(boundary)
        present, wanted = self._rule(boundary), self._wanted
        state = present, wanted, snapshot.scored
        # A preview takes some milliseconds: not at every step of an episode that goes on.
        fresh = time.monotonic() - self._drawn_s < AGAIN_S
        if fresh and self._drawn is not None and state == self._drawn:
            return
        self._drawn, self._drawn_s = state, time.monotonic()
        held_out = self._held_out
        now, then = (preview(episodes, held_out, rule, self._rate_hz) for rule in (present, wanted))
        limits = self._dial is not None and wanted.a_minute != present.a_minute
        self._table.content = _table(now, then, episodes) + _notes(now, bool(held_out), limits)

    @property
    def _judge(self) -> FittedGate | None:
        judge = self._fitted if self._dial is None else self._dial.boundary.judge
        return judge if isinstance(judge, FittedGate) else None

    @property
    def _held_out(self) -> Sequence[np.ndarray]:
        judge = self._judge
        return () if judge is None else judge.held_out.episodes

    @property
    def _wanted(self) -> TurnRule:
        """What the sliders say."""
        assert self._boundary is not None
        return replace(
            self._rule(self._boundary),
            threshold=float(self.threshold.value),
            minimum_hold_steps=round(float(self.turn.value) * self._rate_hz),
            a_minute=int(self.a_minute.value),
        )

    def _now(
        self, snapshot: Snapshot, episodes: Sequence[ScoredEpisode]
    ) -> Boundary | _Present | None:
        """What the gate goes by: of one that runs, or as it was recorded."""
        if self._dial is not None:
            return self._dial.boundary
        known = snapshot.trace.threshold[np.isfinite(snapshot.trace.threshold)]
        if not len(known):
            return None
        threshold = float(known[-1])
        if self._boundary is not None and self._boundary.threshold == threshold:
            return self._boundary
        scores = np.concatenate([each.scores for each in episodes])
        return _Present(threshold, *span_of(threshold, scores))

    def _rule(self, boundary: Boundary | _Present) -> TurnRule:
        judge = self._judge
        if judge is None:
            return TurnRule(boundary.threshold, boundary.minimum_hold_steps or 0)
        config, hold = judge.config, boundary.minimum_hold_steps
        return TurnRule(
            boundary.threshold,
            config.minimum_hold_steps if hold is None else hold,
            judge.release_margin + config.release_margin,
            config.quiet_steps,
            config.requests.a_minute,
            config.dose_every_steps,
        )

    def _begin_at(self, boundary: Boundary | _Present) -> None:
        """Put the sliders to what is, on round numbers around all that the boundary allows."""
        self._boundary = boundary
        step = 10.0 ** math.floor(math.log10((boundary.highest - boundary.lowest) / LEAST_STEPS))
        digits = max(0, -math.floor(math.log10(step)))
        self.threshold.step, self.threshold.precision = step, digits
        self.threshold.min = round(step * math.floor(boundary.lowest / step), digits)
        self.threshold.max = round(step * math.ceil(boundary.highest / step), digits)
        rule = self._rule(boundary)
        self.threshold.value = rule.threshold
        self.turn.value = min(rule.minimum_hold_steps / self._rate_hz, MOST_TURN_S)
        self.a_minute.value = min(rule.a_minute, MOST_A_MINUTE)


def _with_present(snapshot: Snapshot) -> list[ScoredEpisode]:
    """The episodes with scores, and the one that still runs."""
    episodes = [each for each in snapshot.scored if np.isfinite(each.scores).any()]
    score = snapshot.trace.score
    if snapshot.present and snapshot.outcome is None and np.isfinite(score).any():
        episodes.append(ScoredEpisode(score, failed=False, ended=False))
    return episodes


def _table(now: Preview, then: Preview, episodes: Sequence[ScoredEpisode]) -> str:
    def row(name: str, tell: Callable[[Preview], str]) -> str:
        cells = "".join(f"<td>{tell(each)}</td>" for each in (now, then))
        return f'<tr><td style="text-align:left">{escape(name)}</td>{cells}</tr>'

    rows = (
        row("expert acts in", lambda each: _percent(each.expert_share)),
        row("requests a minute", lambda each: _number(each.requests_a_minute)),
        row("false alarms, held-out steps", lambda each: _percent(each.false_alarm_share)),
        row("held-out episodes with one", lambda each: _of(each.false_alarm_episodes)),
        row("failures foreseen", lambda each: _of(each.foreseen)),
        row("asked, though it went well", lambda each: _of(each.needless)),
    )
    tiles = "".join(
        f'<span title="{_title(at, each, first)}" style="display:inline-block;width:11px;'
        f"height:11px;margin:1px;background:{CALM if first is None else palette.css(ASKED)};"
        f'outline:2px solid {palette.css(FAILED) if each.failed else "transparent"}"></span>'
        for at, (each, first) in enumerate(zip(episodes, then.first_request, strict=True), 1)
    )
    return (
        f'<div style="{TEXT}"><table style="width:100%;text-align:right">'
        '<tr style="font-weight:600"><td></td><td>now</td><td>what if</td></tr>'
        f"{''.join(rows)}</table>"
        f'<div style="line-height:1">{tiles}</div>'
        f"{coloured('■', ASKED)} would be asked &nbsp;{coloured('□', FAILED)} failed</div>"
    )


def _notes(now: Preview, has_held_out: bool, limits: bool) -> str:
    told = [ESTIMATE]
    if not has_held_out:
        told.append("False alarms want the checkpoint: with --checkpoint, or trained again.")
    if limits:
        told.append("Apply takes threshold and turn; a limit of requests is --gate.requests.")
    return note(f"{now.steps:,} steps of {len(now.first_request)} episodes. {' '.join(told)}")


def _title(at: int, episode: ScoredEpisode, first: int | None) -> str:
    asked = "never asked" if first is None else f"first asked at step {first + 1}"
    return f"{at}: {'failed, ' * episode.failed}{asked} of {len(episode.scores)}"


def _percent(share: float) -> str:
    return "–" if np.isnan(share) else f"{share:.1%}"


def _number(value: float) -> str:
    return "–" if np.isnan(value) else f"{value:.1f}"


def _of(counts: tuple[int, int]) -> str:
    return f"{counts[0]} of {counts[1]}" if counts[1] else "–"
