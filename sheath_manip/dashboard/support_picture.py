"""The task's plane as a picture: training positions, the support's boundaries, the present."""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from sheath_manip.playback import palette
from sheath_manip.support.plane import PlaneLevels
from sheath_manip.types import Actor, SceneGeom, ScenePose

WIDTH_PX = 480
MAX_HEIGHT_PX = 480
# Of the longer side of the training positions' extent, so that leaving it can be seen.
MARGIN = 0.1
# Thousands of training states must not hide what lies below them.
DOT_OPACITY = 0.3
TINT_OPACITY = 0.12
OUTLINE_OPACITY = 0.7
# OpenCV places antialiased shapes to 1/16 pixel with this shift.
SUBPIXEL_BITS = 4
STRAIGHT_PX = 0.3
"""from a line, so far a joint of a trail may lie and be left out"""


@dataclass(frozen=True, eq=False)
class Ground:
    """A picture that lies in the world's xy plane, not turned about z."""

    pixels: NDArray[np.uint8]
    """(h, w, 3) RGB: row 0 lies at +y, column 0 at -x"""
    centre_m: NDArray[np.float64]
    """(2,)"""
    half_extent_m: NDArray[np.float64]
    """(2,)"""


def ground_of(scene: Sequence[SceneGeom], pose: ScenePose) -> Ground | None:
    """Return the largest picture of `scene`, or None where it shows none."""
    pictures = [geom for geom in scene if geom.shape == "picture" and geom.picture is not None]
    if not pictures:
        return None
    geom = max(pictures, key=lambda picture: float(picture.size[0] * picture.size[1]))
    assert geom.picture is not None
    centre_m = pose.bodies[geom.body, :2] + geom.position_in_body[:2]
    return Ground(geom.picture, centre_m, geom.size[:2])


@dataclass(frozen=True, eq=False)
class Track:
    """The track of an episode: where it has been in the plane."""

    positions: NDArray[np.float64]
    """(n, 2) metres, the present one last"""
    actors: tuple[Actor, ...]
    """n"""


class SupportPicture:
    """Keeps the still part (ground, training, level sets) and draws the rest on a copy."""

    def __init__(
        self,
        ground: Ground | None,
        training: NDArray[np.float64],
        levels: PlaneLevels | None,
    ) -> None:
        low, high = _window(ground, training)
        metres = high - low
        # A window higher than wide would leave the panel's width unused.
        missing_m = max(0.0, metres[1] * WIDTH_PX / MAX_HEIGHT_PX - metres[0])
        beside_m = np.array([missing_m / 2, 0.0])
        low, high = low - beside_m, high + beside_m
        metres = high - low
        self._scale = min(WIDTH_PX / metres[0], MAX_HEIGHT_PX / metres[1])
        self._low, self._high = low, high
        self._width, self._height = (int(v) for v in np.maximum(np.rint(metres * self._scale), 1))
        self._still = self._draw_still(ground, training, levels)

    def draw(self, track: Track) -> NDArray[np.uint8]:
        """Return the (h, w, 3) RGB picture with the trail and the present position of `track`."""
        picture = self._still.copy()
        if not len(track.positions):
            return picture
        points = self._to_pixels(track.positions)
        _polyline(picture, points, (255, 255, 255), 5)
        for colour, run in _runs(track, points):
            _polyline(picture, run, colour, 3)
        # A position beyond the picture is shown on its edge.
        present = np.clip(points[-1], 6, np.array([self._width - 7, self._height - 7]))
        _disc(picture, present, 7, (255, 255, 255))
        _disc(picture, present, 5, palette.ACTOR[track.actors[-1]])
        return picture

    def _draw_still(
        self, ground: Ground | None, training: NDArray[np.float64], levels: PlaneLevels | None
    ) -> NDArray[np.uint8]:
        still = np.full((self._height, self._width, 3), palette.INK, np.uint8)
        if ground is not None:
            still = self._warped(
                ground.pixels, ground.centre_m, ground.half_extent_m, cv2.INTER_AREA
            )
            still = (0.45 * still + 0.55 * np.array(palette.INK)).astype(np.uint8)
        if levels is not None:
            for nu in sorted(levels.scores):
                self._draw_level(still, levels, nu)
        dotted = still.copy()
        for point in self._to_pixels(training):
            _disc(dotted, point, 1, (255, 255, 255))
        return np.asarray(cv2.addWeighted(dotted, DOT_OPACITY, still, 1 - DOT_OPACITY, 0), np.uint8)

    def _draw_level(self, still: NDArray[np.uint8], levels: PlaneLevels, nu: float) -> None:
        x_m, y_m = levels.x_m, levels.y_m
        centre_m = np.array([x_m[0] + x_m[-1], y_m[0] + y_m[-1]]) / 2
        cell_m = np.array([x_m[1] - x_m[0], y_m[1] - y_m[0]])
        half_extent_m = cell_m * (len(x_m), len(y_m)) / 2
        scores = np.asarray(levels.scores[nu][::-1], np.float32)
        field = self._warped(scores, centre_m, half_extent_m, cv2.INTER_CUBIC)
        slope = np.hypot(*np.gradient(field))
        pixels_inside = field / np.maximum(slope, 1e-9)
        tinted = TINT_OPACITY * np.clip(pixels_inside + 0.5, 0, 1)
        outlined = OUTLINE_OPACITY * np.clip(1.2 - np.abs(pixels_inside), 0, 1)
        opacity = np.maximum(tinted, outlined)[..., None]
        still[:] = still + opacity * (np.array(palette.SUPPORT) - still)

    def _warped(
        self,
        pixels: NDArray,
        centre_m: NDArray[np.float64],
        half_extent_m: NDArray[np.float64],
        interpolation: int,
    ) -> NDArray:
        """(height, width[, 3]) `pixels` moved from their place in the plane into the window."""
        rows, columns = pixels.shape[:2]
        corner = self._to_pixels(centre_m + half_extent_m * (-1, 1))
        size = 2 * half_extent_m * self._scale
        # Shrunk first, because warpAffine knows no averaging of the pixels that fall together.
        shrunk = np.minimum((columns, rows), np.maximum(np.rint(size), 1)).astype(int)
        if interpolation == cv2.INTER_AREA:
            pixels = cv2.resize(
                pixels, (int(shrunk[0]), int(shrunk[1])), interpolation=interpolation
            )
            rows, columns = pixels.shape[:2]
            interpolation = cv2.INTER_LINEAR
        zoom_x, zoom_y = size[0] / columns, size[1] / rows
        # OpenCV counts from the middle of the first pixel.
        matrix = np.array(
            [
                [zoom_x, 0, corner[0] + zoom_x / 2 - 0.5],
                [0, zoom_y, corner[1] + zoom_y / 2 - 0.5],
            ]
        )
        # Beyond a ground is nothing; beyond the scores' grid they stay as they are on its edge.
        return cv2.warpAffine(
            pixels,
            matrix,
            (self._width, self._height),
            flags=interpolation,
            borderMode=cv2.BORDER_CONSTANT if pixels.ndim == 3 else cv2.BORDER_REPLICATE,
            borderValue=palette.INK,
        )

    def _to_pixels(self, positions: NDArray) -> NDArray[np.float64]:
        """(..., 2) column and row of positions in metres."""
        x, y = positions[..., 0], positions[..., 1]
        return np.stack([(x - self._low[0]), (self._high[1] - y)], -1) * self._scale


def _window(
    ground: Ground | None, training: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The corners (metres) of what to show: around the training, or all the ground."""
    if not len(training):
        assert ground is not None, "a support picture needs a ground or training positions"
        return ground.centre_m - ground.half_extent_m, ground.centre_m + ground.half_extent_m
    inner_low, inner_high = training.min(0), training.max(0)
    margin = MARGIN * (inner_high - inner_low).max()
    low, high = inner_low - margin, inner_high + margin
    if ground is not None:
        low = np.maximum(low, np.minimum(ground.centre_m - ground.half_extent_m, inner_low))
        high = np.minimum(high, np.maximum(ground.centre_m + ground.half_extent_m, inner_high))
    return low, high


def _runs(track: Track, points: NDArray[np.float64]) -> list[tuple[palette.Rgb, NDArray]]:
    """The trail in pieces of one colour, each beginning where the one before it ended."""
    changes = [i for i in range(1, len(points)) if track.actors[i] != track.actors[i - 1]]
    starts, ends = [0, *changes], [*changes, len(points)]
    return [
        (palette.ACTOR[track.actors[start]], points[max(start - 1, 0) : end])
        for start, end in zip(starts, ends, strict=True)
    ]


def _polyline(
    picture: NDArray[np.uint8], points: NDArray[np.float64], colour: palette.Rgb, width_px: int
) -> None:
    # OpenCV rounds each joint off, which is dear: those that none would see are left out.
    bent = cv2.approxPolyDP(points.astype(np.float32), STRAIGHT_PX, False)
    line = np.rint(bent * 2**SUBPIXEL_BITS).astype(np.int32)
    cv2.polylines(picture, [line], False, colour, width_px, cv2.LINE_AA, SUBPIXEL_BITS)


def _disc(
    picture: NDArray[np.uint8], centre: NDArray[np.float64], radius_px: float, colour: palette.Rgb
) -> None:
    one = 2**SUBPIXEL_BITS
    column, row = (round(float(v) * one) for v in centre)
    cv2.circle(
        picture,
        (column, row),
        round(radius_px * one),
        colour,
        cv2.FILLED,
        cv2.LINE_AA,
        SUBPIXEL_BITS,
    )
