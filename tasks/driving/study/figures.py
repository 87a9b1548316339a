"""Driving's own figures: the support on the road, of positions and of what the gate really sees."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LinearSegmentedColormap, TwoSlopeNorm
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray

from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.experiments.figures.intervention import NothingToShowError
from sheath_manip.experiments.figures.style import EXPERT, GREY, INK, POLICY, drawing, heading
from sheath_manip.learning.checkpoint import Checkpoint
from sheath_manip.playback import palette
from sheath_manip.playback.written import in_percent
from sheath_manip.support.plane import NUS, PlaneLevels, plane_levels
from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.driving.task import DrivingTask
from sheath_manip.tasks.driving.track import Track
from sheath_manip.types import Observation, Purpose
from sheath_manip.types.samples import Samples

ALONG_STEPS, ACROSS_STEPS = 72, 11
"""of the gate's map: a pose every 1.9 m of the lap and every 1.2 m across: 2400 pictures"""
ACROSS_M = 6.0
"""to each side of the centre line, so that the map ends off the road"""
TURNED_DEG = (-30.0, 0.0, 30.0)
"""headings of the map, from the road's"""
FAR_M = 500.0
"""beside the road: where the other cars wait"""
SUPPORT = palette.css(palette.SUPPORT)
GRASS, TARMAC = "#c3d3bd", "#9b9ba3"
GATE_COLOURS = LinearSegmentedColormap.from_list("gate", [EXPERT, "white", POLICY])
SHOWN_PERCENTILE = 5.0
"""of the map's scores, below which all have one colour: far off the road they say no more"""
BATCH = 64


def support(
    store: EpisodeStore, checkpoint: Checkpoint, environment: ComposerEnvironment, path: Path
) -> None:
    """The draft's Fig. 1, from the demonstrations of the checkpoint's training seed."""
    episodes = store.episodes(
        Purpose.DEMONSTRATION, run_seed=checkpoint.run_seed, need_images=False
    )
    features = [[step.observation.features for step in episode.steps] for episode in episodes]
    if not features:
        raise NothingToShowError(
            f"{store.path} holds no demonstrations of seed {checkpoint.run_seed}; "
            "collect some first"
        )
    spec = environment.spec
    columns = [spec.feature_names.index(name) for name in spec.plane or ()]
    draw_support(np.concatenate(features)[:, columns], _task(environment).track, path)


def draw_support(positions: NDArray, track: Track, path: Path, nus: Sequence[float] = NUS) -> None:
    """A panel for each nu: the track from above, (n, 2) positions and where they have support."""
    levels = plane_levels(positions, nus)
    with drawing(path, height_px=1440) as figure:
        heading(
            figure,
            f"The support of the expert's positions covers {_area_m2(levels, nus[0]):.0f} m² at "
            f"ν = {nus[0]:g} and {_area_m2(levels, nus[-1]):.0f} m² at ν = {nus[-1]:g}",
            f"driving; one-class SVM on the (x, y) of {len(positions):,} states; ν is the share of "
            "them that may lie outside",
        )
        panels = figure.subplots(2, 2, sharex=True, sharey=True)
        for axes, nu in zip(panels.ravel(), nus, strict=True):
            grid = (levels.x_m, levels.y_m, levels.scores[nu])
            _ground(axes, track)
            axes.contourf(*grid, [0, np.inf], colors=[SUPPORT], alpha=0.55)
            axes.contour(*grid, [0], colors=[SUPPORT], linewidths=2)
            axes.scatter(*positions.T, s=1.5, color=INK, linewidth=0, zorder=3)
            axes.set_title(f"ν = {nu:g}")
        for axes in panels[:, 0]:
            axes.set_ylabel("y (m)")
        for axes in panels[1]:
            axes.set_xlabel("x (m)")
        shapes = (
            Line2D([], [], linestyle="", marker="o", markersize=3, color=INK),
            Patch(facecolor=SUPPORT, alpha=0.8),
        )
        names = ("a position of the expert", "estimated support")
        figure.legend(shapes, names, loc="outside lower center", ncols=2)


def _area_m2(levels: PlaneLevels, nu: float) -> float:
    """How much of the ground is inside."""
    cell = float(np.diff(levels.x_m[:2])[0] * np.diff(levels.y_m[:2])[0])
    return cell * int((levels.scores[nu] >= 0).sum())


def gate_map(
    store: EpisodeStore,  # noqa: ARG001
    checkpoint: Checkpoint,
    environment: ComposerEnvironment,
    path: Path,
) -> None:
    """The real gate's score over an empty road: each pose rendered, embedded and scored."""
    task = _task(environment)
    along = np.linspace(0, task.track.lap_length, ALONG_STEPS + 1)
    across = np.linspace(-ACROSS_M, ACROSS_M, ACROSS_STEPS)
    poses = task.track.pose(*np.meshgrid(along, across))
    maps = []
    for turned_deg in TURNED_DEG:
        turned = poses + np.array([0.0, 0.0, np.deg2rad(turned_deg)])
        # The first column is the last one again.
        scores = pose_scores(checkpoint, environment, turned[:, :-1].reshape(-1, 3))
        scores = scores.reshape(ACROSS_STEPS, ALONG_STEPS)
        maps.append(np.concatenate([scores, scores[:, :1]], 1) - checkpoint.threshold)
    lowest = float(np.nanpercentile(maps, SHOWN_PERCENTILE))
    highest = float(np.nanmax(maps))
    ends = min(lowest, -1e-6), max(highest, 1e-6)
    norm = TwoSlopeNorm(0.0, *ends)
    on_road = np.abs(across) <= task.track.road_half_width
    straight = maps[TURNED_DEG.index(0.0)] >= 0
    with drawing(path, height_px=580) as figure:
        heading(
            figure,
            f"The gate trusts the policy at {in_percent(straight[on_road].mean())} of the places "
            f"on the road, and at {in_percent(straight[~on_road].mean())} beside it",
            f"driving along an empty road, {checkpoint.method or 'policy'}, round "
            f"{checkpoint.round}, seed {checkpoint.run_seed}, counter-clockwise; black: the "
            "gate's threshold",
        )
        panels = figure.subplots(1, len(maps), sharey=True)
        for axes, turned_deg, scores in zip(panels, TURNED_DEG, maps, strict=True):
            axes.pcolormesh(
                *np.moveaxis(poses[..., :2], -1, 0),
                scores,
                shading="gouraud",
                cmap=GATE_COLOURS,
                norm=norm,
            )
            axes.contour(poses[..., 0], poses[..., 1], scores, [0.0], colors=[INK], linewidths=1)
            for lateral in (-task.track.road_half_width, task.track.road_half_width):
                x, y, _ = np.moveaxis(task.track.pose(along, np.full_like(along, lateral)), -1, 0)
                axes.plot(x, y, color=GREY, linewidth=1, linestyle=(0, (4, 3)))
            axes.set_aspect("equal")
            axes.grid(False)
            side = "to the left" if turned_deg > 0 else "to the right"
            turn = f"turned {abs(turned_deg):.0f}° {side}" if turned_deg else "along the road"
            axes.set_title(f"heading {turn}")
            axes.set_xlabel("x (m)")
        panels[0].set_ylabel("y (m)")
        bar = figure.colorbar(
            ScalarMappable(norm, GATE_COLOURS), ax=panels, shrink=0.8, pad=0.01, extend="min"
        )
        # Each side of the threshold has a scale of its own.
        bar.set_ticks([*_round_inside(ends[0]), 0.0, *_round_inside(ends[1])])
        bar.set_label("score − threshold\nexpert drives   |   policy drives")


def _round_inside(end: float) -> list[float]:
    """Two round numbers between 0 and `end`, in ascending order."""
    power = 10.0 ** np.floor(np.log10(abs(end)))
    largest, next_one = next(
        pair for pair in ((5, 2), (2, 1), (1, 0.5)) if pair[0] * power <= abs(end)
    )
    return sorted(float(np.sign(end)) * each * power for each in (largest, next_one))


def pose_scores(
    checkpoint: Checkpoint, environment: ComposerEnvironment, poses: NDArray
) -> NDArray[np.float64]:
    """(n,) the gate's scores at (n, 3) x (m), y (m), heading (rad), with no other car in sight."""
    task = _task(environment)
    environment.reset(0)
    # Not before the reset, which may compile the model anew.
    physics = environment.physics
    assert physics is not None
    away = np.full(task.scenario.cars, -FAR_M)
    task.set_traffic(physics, np.stack([np.zeros_like(away), away], 1))

    def seen(pose: NDArray) -> Observation:
        task.place(physics, pose)
        physics.forward()
        return environment.observe()

    scores = []
    for first in range(0, len(poses), BATCH):
        batch = [seen(pose) for pose in poses[first : first + BATCH]]
        images = {
            camera: np.stack([observation.images[camera] for observation in batch])
            for camera in environment.spec.cameras
        }
        features = np.stack([observation.features for observation in batch])
        nothing = np.full((len(batch), len(environment.spec.action.names)), np.nan, np.float32)
        states = Samples(images, features, nothing, np.zeros(len(batch), np.int64))
        scores.append(checkpoint.fitted.scores(states))
    return np.concatenate(scores)


def _task(environment: ComposerEnvironment) -> DrivingTask:
    if not isinstance(environment.task, DrivingTask):
        raise TypeError(f"driving's figures want a DrivingTask, got {environment.task!r}")
    return environment.task


def _ground(axes: Axes, track: Track) -> None:
    """Paint grass and road, without the grain of the track's own picture."""
    along = np.linspace(0, track.lap_length, 400)
    edges = (-track.road_half_width, track.road_half_width)
    outer, inner = (track.pose(along, np.full_like(along, edge))[:, :2].T for edge in edges)
    axes.set_facecolor(GRASS)
    axes.fill(*outer, facecolor=TARMAC, edgecolor="white", linewidth=1.5)
    axes.fill(*inner, facecolor=GRASS, edgecolor="white", linewidth=1.5)
    around_m = track.road_half_width + 2.0
    axes.set_xlim(-track.half_length - around_m, track.half_length + around_m)
    axes.set_ylim(-track.half_width - around_m, track.half_width + around_m)
    axes.set_aspect("equal")
    axes.grid(False)
