"""The race track: a rectangle with rounded corners, its coordinates and its picture."""

from dataclasses import dataclass
from functools import cache, cached_property

import cv2
import numpy as np
from numpy.typing import NDArray

GRASS = (74, 122, 62)
_TARMAC = (92, 92, 98)
_EDGE = (236, 236, 236)
_CENTRE = (226, 196, 84)


@dataclass(frozen=True, eq=False)
class _Pieces:
    """The lap in pieces: half a straight, then corner and straight in turn."""

    starts: NDArray[np.float64]
    """(9,) where each begins along the lap"""
    straights: NDArray[np.float64]
    """(5, 2) where each straight begins"""
    corners: NDArray[np.float64]
    """(4, 2) middles, in driving order"""


@dataclass(frozen=True)
class Track:
    """A closed road around the origin, driven counter-clockwise. All lengths in metres.

    Track coordinates are (s, lateral): s along the centre line from the middle of the bottom
    straight, lateral to the left of it (towards the inside).
    """

    half_length: float = 22.0
    """of the centre line's rectangle along x"""
    half_width: float = 16.0
    """of the centre line's rectangle along y"""
    corner_radius: float = 10.0
    road_half_width: float = 4.5
    margin: float = 24.0
    """of grass around the centre line's rectangle, so that no camera looks over the edge"""

    @property
    def lap_length(self) -> float:
        """The length of the centre line."""
        straight_x = self.half_length - self.corner_radius
        straight_y = self.half_width - self.corner_radius
        return 4 * (straight_x + straight_y) + 2 * np.pi * self.corner_radius

    @property
    def extent(self) -> tuple[float, float]:
        """Half extents of the ground along x and y."""
        return self.half_length + self.margin, self.half_width + self.margin

    @cached_property
    def _pieces(self) -> _Pieces:
        # Traffic asks four times in each control step.
        run_x = self.half_length - self.corner_radius
        run_y = self.half_width - self.corner_radius
        radius = self.corner_radius
        quarter = np.pi / 2 * radius
        lengths = np.array(
            [run_x, quarter, 2 * run_y, quarter, 2 * run_x, quarter, 2 * run_y, quarter, run_x]
        )
        return _Pieces(
            starts=np.concatenate([[0.0], np.cumsum(lengths)[:-1]]),
            straights=np.array(
                [
                    [0, -run_y - radius],
                    [run_x + radius, -run_y],
                    [run_x, run_y + radius],
                    [-run_x - radius, run_y],
                    [-run_x, -run_y - radius],
                ]
            ),
            corners=np.array([[run_x, -run_y], [run_x, run_y], [-run_x, run_y], [-run_x, -run_y]]),
        )

    def pose(self, s: NDArray, lateral: NDArray) -> NDArray[np.float64]:
        """(..., 3) x (m), y (m) and heading (rad) of the road at track coordinates (s, lateral)."""
        s, lateral = np.broadcast_arrays(np.asarray(s, float), np.asarray(lateral, float))
        pieces = self._pieces
        s = np.mod(s, self.lap_length)
        piece = np.clip(np.searchsorted(pieces.starts, s, side="right") - 1, 0, 8)
        along = s - pieces.starts[piece]
        radius = self.corner_radius
        straight = piece % 2 == 0
        base = (piece // 2) * np.pi / 2
        heading = np.where(straight, base, base + along / radius)
        number = piece // 2
        on_straight = pieces.straights[number] + along[..., None] * np.stack(
            [np.cos(base), np.sin(base)], -1
        )
        outward = np.stack([np.sin(heading), -np.cos(heading)], -1)
        on_corner = pieces.corners[np.minimum(number, 3)] + radius * outward
        point = np.where(straight[..., None], on_straight, on_corner) - lateral[..., None] * outward
        return np.concatenate([point, heading[..., None]], -1)

    def coordinates(self, x: NDArray, y: NDArray) -> tuple[NDArray, NDArray, NDArray]:
        """Return (s, lateral, heading of the road) of the centre line's point nearest to (x, y)."""
        x, y = np.asarray(x, float), np.asarray(y, float)
        run_x = self.half_length - self.corner_radius
        run_y = self.half_width - self.corner_radius
        over_x, over_y = np.abs(x) - run_x, np.abs(y) - run_y
        in_corner = (over_x > 0) & (over_y > 0)
        quarter = np.pi / 2 * self.corner_radius
        # Corners in driving order: bottom right, top right, top left, bottom left.
        corner = np.where(y < 0, np.where(x > 0, 0, 3), np.where(x > 0, 1, 2))
        middle_x, middle_y = np.sign(x) * run_x, np.sign(y) * run_y
        bearing = np.arctan2(y - middle_y, x - middle_x)
        turned = np.mod(bearing - (corner * np.pi / 2 - np.pi / 2), 2 * np.pi)
        corner_starts = np.array(
            [
                run_x,
                run_x + quarter + 2 * run_y,
                3 * run_x + 2 * quarter + 2 * run_y,
                3 * run_x + 3 * quarter + 4 * run_y,
            ]
        )
        s_corner = corner_starts[corner] + turned * self.corner_radius
        lateral_corner = self.corner_radius - np.hypot(x - middle_x, y - middle_y)
        heading_corner = corner * np.pi / 2 + turned

        # On a straight (or inside the ring) the nearest side decides.
        gap_x, gap_y = self.half_length - np.abs(x), self.half_width - np.abs(y)
        on_side = gap_x < gap_y
        lateral_straight = np.where(on_side, gap_x, gap_y)
        side = np.where(on_side, np.where(x > 0, 1, 3), np.where(y < 0, 0, 2))
        clipped_x, clipped_y = np.clip(x, -run_x, run_x), np.clip(y, -run_y, run_y)
        s_straight = np.choose(
            side,
            [
                clipped_x,
                run_x + quarter + run_y + clipped_y,
                2 * run_x + 2 * quarter + 2 * run_y - clipped_x,
                3 * run_x + 3 * quarter + 3 * run_y - clipped_y,
            ],
        )
        s = np.mod(np.where(in_corner, s_corner, s_straight), self.lap_length)
        lateral = np.where(in_corner, lateral_corner, lateral_straight)
        heading = np.where(in_corner, heading_corner, side * np.pi / 2)
        return s, lateral, heading

    def picture(self, pixels_per_m: float = 14.0) -> NDArray[np.uint8]:
        """(h, w, 3) RGB of the ground: row 0 lies at +y, column 0 at -x."""
        extent_x, extent_y = self.extent
        width, height = round(2 * extent_x * pixels_per_m), round(2 * extent_y * pixels_per_m)
        x = (np.arange(width) + 0.5) / pixels_per_m - extent_x
        y = extent_y - (np.arange(height) + 0.5) / pixels_per_m
        s, lateral, _ = self.coordinates(*np.meshgrid(x, y))
        # Fixed speckles give the ground a texture that moves with the world, not with the car.
        speckle = np.random.default_rng(0).normal(0, 1, (height // 6 + 1, width // 6 + 1))
        grain = cv2.resize(speckle, (width, height), interpolation=cv2.INTER_CUBIC)
        image = np.empty((height, width, 3))
        image[:] = GRASS
        image += 6 * grain[..., None]
        road = np.abs(lateral) <= self.road_half_width
        image[road] = np.array(_TARMAC) + 2 * grain[road][:, None]
        image[np.abs(np.abs(lateral) - self.road_half_width + 0.15) < 0.15] = _EDGE
        image[(np.abs(lateral) < 0.12) & (np.mod(s, 4.0) < 2.0)] = _CENTRE
        image[(np.abs(lateral) < self.road_half_width) & (s < 0.5)] = _EDGE
        return np.clip(image, 0, 255).astype(np.uint8)


@cache
def picture_png(track: Track) -> bytes:
    """Return the track's picture as a PNG: it takes longer than all else of an environment."""
    _, png = cv2.imencode(".png", cv2.cvtColor(track.picture(), cv2.COLOR_RGB2BGR))
    return png.tobytes()
