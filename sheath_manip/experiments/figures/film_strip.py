"""One intervention as a strip of frames above the support score."""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from sheath_manip.experiments.figures.intervention import Intervention, expert_acted
from sheath_manip.experiments.figures.style import EXPERT, GREY, INK, POLICY, drawing, heading
from sheath_manip.types import Actor, Step

FRAMES = 7


def film_strip(shown: Intervention, path: Path) -> None:
    """Frames framed in the colour of who acts, and below them score and threshold over time."""
    info, steps = shown.episode.info, shown.episode.steps
    window = shown.window
    frames = np.rint(np.linspace(window.start, window.stop - 1, FRAMES)).astype(int)
    with drawing(path, height_px=820) as figure:
        heading(
            figure,
            "An intervention: the policy leaves its support, the expert acts "
            f"for {shown.expert_s:.1f} s" + (" and hands back" if window.stop > shown.stop else ""),
            f"{info.task}, round {info.round}, seed {info.run_seed}, scene {info.seed}; the frames "
            "are marked below by their letters",
        )
        above, below = figure.subfigures(2, 1, squeeze=False, height_ratios=(1, 1.25))[:, 0]
        images = shown.view.pictures(shown.episode, frames.tolist())
        for number, axes in enumerate(above.subplots(1, FRAMES)):
            step = steps[frames[number]]
            _frame(axes, step, images[number], chr(ord("a") + number))
        axes = below.subplots()
        _score(axes, shown)
        top = axes.get_ylim()[1]
        for number, index in enumerate(frames):
            time_s = steps[index].observation.time_s
            axes.axvline(time_s, color=GREY, linewidth=0.8, linestyle=":", zorder=1)
            axes.text(
                time_s, top, chr(ord("a") + number), ha="center", va="bottom", fontweight="bold"
            )


def _frame(axes: Axes, step: Step, image: NDArray[np.uint8], letter: str) -> None:
    axes.imshow(image, interpolation="lanczos")
    axes.set_xticks([])
    axes.set_yticks([])
    axes.grid(False)
    colour = POLICY if step.decision.actor is Actor.POLICY else EXPERT
    for spine in axes.spines.values():
        spine.set(visible=True, color=colour, linewidth=4)
    axes.set_title(f"{letter}  {step.decision.actor}", color=colour, fontweight="bold")
    axes.set_xlabel(f"{step.observation.time_s:.1f} s", color=GREY)


def _score(axes: Axes, shown: Intervention) -> None:
    """Score and threshold, shaded by who acts; crosses where policy and expert differ."""
    steps = shown.episode.steps[shown.window]
    times = np.array([step.observation.time_s for step in steps])
    scores = np.array([step.decision.score for step in steps])
    expert = expert_acted(shown.episode)[shown.window]
    half = 0.5 / shown.episode.info.control_rate_hz
    for colour, who, name in ((POLICY, ~expert, "policy acts"), (EXPERT, expert, "expert acts")):
        for number, time_s in enumerate(times[who]):
            axes.axvspan(
                time_s - half,
                time_s + half,
                color=colour,
                alpha=0.13,
                linewidth=0,
                label=name if number == 0 else None,
            )
    axes.plot(times, scores, color=INK, marker="o", markersize=4, label="support score")
    threshold = [step.decision.threshold for step in steps]
    axes.plot(times, threshold, color=INK, linestyle=(0, (4, 3)), linewidth=1, label="threshold")
    differ = shown.view.disagreed(shown.episode)[shown.window]
    low, high = axes.get_ylim()
    axes.set_ylim(low - 0.22 * (high - low), high)
    axes.plot(
        times[differ],
        np.full(int(differ.sum()), low - 0.1 * (high - low)),
        linestyle="",
        marker="x",
        color=INK,
        markersize=6,
        label="policy and expert want different actions",
    )
    axes.set_xlim(times[0] - half, times[-1] + half)
    axes.set_xlabel("time in the episode (s)")
    axes.set_ylabel("support score")
    axes.figure.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=5)
