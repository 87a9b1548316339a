"""One intervention as a strip of frames above the support score."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from sheath_manip.experiments.figures.intervention import Intervention, expert_acted
from sheath_manip.experiments.figures.style import (
    EXPERT,
    GREY,
    INK,
    POLICY,
    drawing,
    heading,
    round_ticks,
)
from sheath_manip.metrics import runs_of
from sheath_manip.playback import palette
from sheath_manip.playback.labels import actor_label
from sheath_manip.support.calibration import REJECT_ALL
from sheath_manip.types import Reason

FRAMES = 5
ALWAYS = 0.9
"""share of the steps in which policy and expert differ, from which on a band says nothing"""
_LEADS = {
    Reason.OUTSIDE: "The policy leaves its support",
    Reason.RISK: "The policy wants what no expert did in such a state",
}
"""what leads to an intervention, where it is one of the gate's two questions"""


def film_strip(shown: Intervention, path: Path, note: str = "") -> None:
    """Frames framed in the colour of who acts, and below them score and threshold over time.

    A `note` says below the title what else must be known of the run, such as its plan.
    """
    episode, window = shown.episode, shown.window
    info = episode.info
    # One more than there are steps where the episode ends in it.
    last = window.stop - (window.stop < len(episode))
    moments = np.rint(np.linspace(window.start, last, FRAMES)).astype(int).tolist()
    images = shown.view.pictures(episode, moments)
    # A narrow picture leaves room that nobody needs.
    tall = 320 * images[0].shape[0] / images[0].shape[1] + 130
    with drawing(path, height_px=round(min(tall, 450) + 520)) as figure:
        heading(
            figure,
            _finding(shown),
            f"{info.task}, {info.method}, round {info.round}, training seed {info.run_seed}, "
            f"scene {info.seed}{note and f', {note}'}{_always(shown)}; the letters mark the frames "
            "below",
        )
        ratios = (min(tall, 450), 430)
        above, below = figure.subfigures(2, 1, squeeze=False, height_ratios=ratios)[:, 0]
        for number, axes in enumerate(above.subplots(1, FRAMES)):
            _frame(axes, shown, moments[number], images[number], chr(ord("a") + number))
        axes = below.subplots()
        _score(axes, shown)
        top = axes.get_ylim()[1]
        for number, moment in enumerate(moments):
            time_s = _time_s(shown, moment)
            axes.axvline(time_s, color=GREY, linewidth=0.8, linestyle=":", zorder=1)
            axes.text(
                time_s, top, chr(ord("a") + number), ha="center", va="bottom", fontweight="bold"
            )


def _finding(shown: Intervention) -> str:
    decision = shown.episode.steps[shown.start].decision
    lead = _LEADS.get(decision.reason, f"The gate says {decision.reason.value!r}")
    who = actor_label(decision.actor, decision.reason).removesuffix(" acts")
    back = " and hands back" if shown.window.stop > shown.stop else ""
    return f"{lead}: the {who} acts for {shown.expert_s:.1f} s{back}"


def _differ(shown: Intervention) -> NDArray[np.bool_]:
    return shown.view.disagreed(shown.episode)[shown.window]


def _always(shown: Intervention) -> str:
    """In words what else is a band below the score."""
    differ = _differ(shown)
    if differ.mean() < ALWAYS:
        return ""
    return f"; policy and expert want different actions in {differ.sum()} of {len(differ)} steps"


def _time_s(shown: Intervention, moment: int) -> float:
    steps = shown.episode.steps
    if moment < len(steps):
        return steps[moment].observation.time_s
    return shown.episode.final_observation.time_s


def _frame(
    axes: Axes, shown: Intervention, moment: int, image: NDArray[np.uint8], letter: str
) -> None:
    axes.imshow(image, interpolation="lanczos")
    axes.set_xticks([])
    axes.set_yticks([])
    axes.grid(False)
    episode = shown.episode
    if moment < len(episode):
        decision = episode.steps[moment].decision
        colour = palette.css(palette.turn(decision.actor, decision.reason))
        words = decision.actor.value
    else:
        colour, words = palette.css(palette.OUTCOME[episode.outcome]), episode.outcome.value
    for spine in axes.spines.values():
        spine.set(visible=True, color=colour, linewidth=4)
    axes.set_title(f"{letter}  {words}", color=INK, fontweight="bold")
    axes.set_xlabel(f"{_time_s(shown, moment):.1f} s", color=GREY)


def _score(axes: Axes, shown: Intervention) -> None:
    """Score and threshold, shaded by who acts; a band where policy and expert differ."""
    steps = shown.episode.steps[shown.window]
    times = np.array([step.observation.time_s for step in steps])
    scores = _drawable([step.decision.score for step in steps])
    expert = expert_acted(shown.episode)[shown.window]
    step_s = 1 / shown.episode.info.control_rate_hz
    # Hatched as well, for those who see no colours.
    for mask, colour, hatch, name in (
        (~expert, POLICY, "", "policy acts"),
        (expert, EXPERT, "////", "expert acts"),
    ):
        spans = _spans(times, mask, step_s)
        look: dict[str, Any] = {
            "facecolor": f"{colour}22",
            "edgecolor": f"{colour}44",
            "hatch": hatch,
        }
        for number, (start, stop) in enumerate(spans):
            label = name if number == 0 else None
            axes.axvspan(start, stop, **look, linewidth=0, label=label)
    axes.plot(times, scores, color=INK, marker="o", markersize=4, label="score")
    threshold = _drawable([step.decision.threshold for step in steps])
    axes.plot(times, threshold, color=INK, linestyle=(0, (4, 3)), linewidth=1, label="threshold")
    low, high = axes.get_ylim()
    bottom = low - 0.14 * (high - low)
    differ = _differ(shown)
    spans = [] if differ.mean() >= ALWAYS else _spans(times, differ, step_s)
    for number, (start, stop) in enumerate(spans):
        axes.fill_between(
            [start, stop],
            bottom,
            bottom + 0.07 * (high - low),
            color=INK,
            linewidth=0,
            label="policy and expert want different actions" if number == 0 else None,
        )
    axes.set_ylim(bottom, high)
    ends = shown.window.stop == len(shown.episode)
    axes.set_xlim(times[0] - step_s / 2, times[-1] + (1.5 if ends else 0.5) * step_s)
    round_ticks(axes.xaxis, 8)
    round_ticks(axes.yaxis, 5)
    axes.set_xlabel("time in the episode (s)")
    axes.set_ylabel("score")
    axes.figure.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=5)


def _drawable(values: Sequence[float]) -> NDArray[np.float64]:
    """NaN, which is not drawn, for what has no bound."""
    array = np.array(values, float)
    return np.where(np.abs(array) < REJECT_ALL, array, np.nan)


def _spans(
    times: NDArray[np.float64], mask: NDArray[np.bool_], step_s: float
) -> list[tuple[float, float]]:
    """Return (from, until) in seconds of each run of steps in which `mask` (t,) holds."""
    return [
        (times[start] - step_s / 2, times[stop - 1] + step_s / 2) for start, stop in runs_of(mask)
    ]
