"""A toy task for a tool in a plane: follow a line on the table, which a camera above sees."""

from dataclasses import replace
from functools import cache
from typing import Any

import cv2
import numpy as np

from sheath_manip.policies import make_policy
from sheath_manip.protocols import TrainablePolicy
from sheath_manip.types import ActionSpec, TaskSpec, ToolFrame
from sheath_manip.types.samples import Samples

SIDE_PX = 48
PX_M = 0.002
SPEED = 0.6
ACTION = ActionSpec(
    ("velocity_x", "velocity_y"),
    np.full(2, -1, np.float32),
    np.full(2, 1, np.float32),
    tolerance=0.1,
)
MIDDLE = (SIDE_PX - 1) / 2
FRAME = ToolFrame(
    camera="above",
    # +y is upwards in the picture.
    px_of_plane=np.array([[1 / PX_M, 0, MIDDLE], [0, -1 / PX_M, MIDDLE], [0, 0, 1]]),
    position=("tool_x_m", "tool_y_m"),
    heading=("heading_cos", "heading_sin"),
    vector=("velocity_x", "velocity_y"),
)
SPEC = TaskSpec(
    name="line",
    control_rate_hz=20.0,
    action=ACTION,
    cameras={"above": (SIDE_PX, SIDE_PX)},
    feature_names=(*FRAME.position, "depth_m", *FRAME.heading),
    max_steps=100,
    metric="steps",
    plane=FRAME.position,
    tool_frame=FRAME,
)
SETTINGS: dict[str, Any] = {
    "side_px": 48,
    "px_m": 0.0014,
    "spatial_settings": {
        "channels": (8, 8, 8, 8),
        "hidden": (64,),
        "steps": 250,
        "warm_steps": 20,
        "batch_size": 32,
        "learning_rate": 3e-3,
        "shift_px": 0,
    },
}
"""with which the toy is learned in seconds"""


def line_samples(count: int, seed: int, spread_m: float = 0.016) -> Samples:
    """Tools up to `spread_m` from the middle, heading anywhere; 50 states an episode.

    The line is up to a centimetre to a side and up to half a radian askew; it is to be followed,
    and approached in proportion. A deeper tool is to go slower.
    """
    rng = np.random.default_rng(seed)
    return _seen(
        rng.uniform(-spread_m, spread_m, (count, 2)),
        rng.uniform(-np.pi, np.pi, count),
        rng.uniform(-0.5, 0.5, count),
        rng.uniform(-0.01, 0.01, count),
        rng.uniform(-1, 1, count),
        rng,
    )


def samples_at(tool_m: tuple[float, float], heading_rad: float, beside_m: float) -> Samples:
    """One state in which the tool heads along the line that it is beside."""
    none = np.zeros(1)
    return _seen(
        np.array([tool_m]),
        np.array([heading_rad]),
        none,
        np.array([beside_m]),
        none,
        np.random.default_rng(0),
    )


def turned(samples: Samples) -> Samples:
    """All of it a quarter to the left: robot, line, camera's picture."""
    features = samples.features.copy()
    for first in (0, 3):
        features[:, first : first + 2] = _left(samples.features[:, first : first + 2])
    images = {"above": np.rot90(samples.images["above"], axes=(1, 2)).copy()}
    return replace(samples, images=images, features=features, labels=_left(samples.labels))


def _left(vectors: np.ndarray) -> np.ndarray:
    return np.stack([-vectors[:, 1], vectors[:, 0]], axis=1)


def _seen(
    tools_m: np.ndarray,
    headings: np.ndarray,
    askew: np.ndarray,
    beside_m: np.ndarray,
    depths: np.ndarray,
    rng: np.random.Generator,
) -> Samples:
    count = len(tools_m)
    along = np.stack([np.cos(headings + askew), np.sin(headings + askew)], axis=1)
    across = np.stack([-along[:, 1], along[:, 0]], axis=1)
    images = rng.integers(90, 110, (count, SIDE_PX, SIDE_PX, 3), dtype=np.uint8)
    for image, tool_m, way, side, offset_m in zip(
        images, tools_m, along, across, beside_m, strict=True
    ):
        ends_m = tool_m + offset_m * side + np.array([[-0.2], [0.2]]) * way
        ends = np.column_stack([ends_m, np.ones(2)]) @ FRAME.px_of_plane.T
        first, last = np.round(ends[:, :2]).astype(int).tolist()
        cv2.line(image, first, last, (30, 60, 220), 2)
    speeds = SPEED - 0.2 * depths[:, None]
    labels = speeds * along + (beside_m[:, None] / 0.03) * across
    placed = [tools_m, 0.01 * depths[:, None], np.cos(headings)[:, None], np.sin(headings)[:, None]]
    features = np.concatenate(placed, axis=1).astype(np.float32)
    clipped = np.clip(labels, -1, 1).astype(np.float32)
    return Samples({"above": images}, features, clipped, np.arange(count) // 50)


@cache
def training() -> Samples:
    return line_samples(400, seed=0)


@cache
def held_out() -> Samples:
    return line_samples(200, seed=1)


@cache
def fitted_policy(name: str = "egocentric-cnn") -> TrainablePolicy:
    """Fitted once for all tests, which must not fit it again."""
    return make_policy(name, SPEC, seed=0, **SETTINGS).fit(training())
