"""What differs from episode to episode: how the sheet lies, its material, what happens to it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sheath_manip.tasks.gauze_cutting.geometry import CENTRE_M, CORNERS_M


@dataclass(frozen=True)
class Difficulty:
    """Ranges to draw from; a single number is the largest deviation to both sides."""

    position_m: float = 0.005
    yaw_rad: float = float(np.deg2rad(15))
    clip_m: float = 0.002
    """of each clip along each axis"""
    pretension: tuple[float, float] = (0.015, 0.03)
    """strain"""
    sag_m: tuple[float, float] = (0.001, 0.004)
    """in the middle, of the bed that the sheet lies on"""
    stiffness: tuple[float, float] = (0.7, 1.5)
    """factor, evenly in its logarithm like the next"""
    drag: tuple[float, float] = (0.5, 2.0)
    puncture_m: float = 0.0004
    """beside the line"""
    slips: tuple[int, int] = (4, 6)
    """how often a clip slips, or the frame with all of them is pushed"""
    slip_m: tuple[float, float] = (0.002, 0.004)
    slip_s: tuple[float, float] = (0.8, 1.6)
    within_s: float = 8.0
    """of the episode's start, in which they happen"""


DEFAULT = Difficulty()
CALM = Difficulty(slips=(0, 0))
"""the sheet lies as it will, but nothing happens to it while it is cut"""
NOMINAL = Difficulty(
    position_m=0.0,
    yaw_rad=0.0,
    clip_m=0.0,
    pretension=(0.02, 0.02),
    sag_m=(0.002, 0.002),
    stiffness=(1.0, 1.0),
    drag=(1.0, 1.0),
    puncture_m=0.0,
    slips=(0, 0),
)
"""nothing out of place: where someone who does not look takes the sheet to be"""
DRAG_N = 0.01
"""Coulomb friction between blade and sheet, before its factor"""


@dataclass(frozen=True)
class Slip:
    """Clips move and stay where they have come to."""

    clips: tuple[int, ...]
    way_m: tuple[float, float]
    """in the world frame"""
    start_s: float
    duration_s: float


@dataclass(frozen=True, eq=False)
class Scene:
    """One episode's workpiece."""

    centre_m: NDArray[np.float64]
    """(3,) world frame"""
    yaw_rad: float
    clips_m: NDArray[np.float64]
    """(4, 2) displacements of the clips in the sheet's frame, pretension included"""
    sag_m: float
    stiffness: float
    """factor on Young's modulus"""
    drag_n: float
    start_rad: float
    """where on the circle the blade is put in"""
    puncture_m: float
    """how far outside of the circle"""
    slips: tuple[Slip, ...]

    @property
    def rotation(self) -> NDArray[np.float64]:
        """The (2, 2) rotation from the sheet's frame to the world's."""
        cos, sin = np.cos(self.yaw_rad), np.sin(self.yaw_rad)
        return np.array([[cos, -sin], [sin, cos]])

    def clip_positions_m(self, time_s: float) -> NDArray[np.float64]:
        """Return the clips' (4, 3) positions in the world frame."""
        positions = np.tile(self.centre_m, (4, 1))
        positions[:, :2] += (CORNERS_M + self.clips_m) @ self.rotation.T
        for slip in self.slips:
            share = min(max((time_s - slip.start_s) / slip.duration_s, 0.0), 1.0)
            # Without a jerk at either end.
            positions[list(slip.clips), :2] += share**2 * (3 - 2 * share) * np.array(slip.way_m)
        return positions


def draw_scene(rng: np.random.Generator, difficulty: Difficulty) -> Scene:
    """The scene that belongs to the state of `rng`."""
    spread = difficulty.position_m
    centre = CENTRE_M.copy()
    centre[:2] += rng.uniform(-spread, spread, 2)
    yaw = float(rng.uniform(-difficulty.yaw_rad, difficulty.yaw_rad))
    clips = rng.uniform(*difficulty.pretension) * CORNERS_M
    clips = clips + rng.uniform(-difficulty.clip_m, difficulty.clip_m, (4, 2))
    number = int(rng.integers(difficulty.slips[0], difficulty.slips[1] + 1))
    return Scene(
        centre_m=centre,
        yaw_rad=yaw,
        clips_m=clips,
        sag_m=float(rng.uniform(*difficulty.sag_m)),
        stiffness=float(np.exp(rng.uniform(*np.log(difficulty.stiffness)))),
        drag_n=DRAG_N * float(np.exp(rng.uniform(*np.log(difficulty.drag)))),
        start_rad=float(rng.uniform(-np.pi, np.pi)),
        puncture_m=float(rng.uniform(-difficulty.puncture_m, difficulty.puncture_m)),
        slips=tuple(_slip(rng, difficulty) for _ in range(number)),
    )


def _slip(rng: np.random.Generator, difficulty: Difficulty) -> Slip:
    clip = int(rng.integers(8))
    length, angle = rng.uniform(*difficulty.slip_m), rng.uniform(-np.pi, np.pi)
    return Slip(
        # Half of the time it is the frame that is pushed.
        clips=(clip,) if clip < 4 else (0, 1, 2, 3),
        way_m=(float(length * np.cos(angle)), float(length * np.sin(angle))),
        start_s=float(rng.uniform(0.3, difficulty.within_s)),
        duration_s=float(rng.uniform(*difficulty.slip_s)),
    )
