"""Draws scenes: a red target with standing objects around it."""

from dataclasses import dataclass, replace

import numpy as np

from sheath_manip.tasks.grasp_clutter.objects import Kind, StandingObject

POOL = {Kind.CAN: 3, Kind.BOTTLE: 3, Kind.BOX: 3}
"""how many of a kind a scene may hold beside the target"""
TABLE_X_M = (0.15, 0.85)
TABLE_Y_M = (-0.45, 0.45)
"""what lies beyond is off the table"""
TARGET_RGBA = (0.85, 0.08, 0.06, 1.0)
_PALETTE = (
    (0.16, 0.36, 0.72, 1.0),
    (0.20, 0.58, 0.32, 1.0),
    (0.92, 0.78, 0.22, 1.0),
    (0.55, 0.30, 0.62, 1.0),
    (0.85, 0.85, 0.82, 1.0),
    (0.24, 0.62, 0.66, 1.0),
)
_STEP_BACK_M = 0.004
_TRIES = 60
"""to place one object before the whole draw is given up"""


@dataclass(frozen=True)
class Difficulty:
    """How cluttered a scene is."""

    gap_m: float
    """least distance of clutter from the target"""
    spread_m: float
    """how much farther than that it stands, if there is room"""
    heights_m: tuple[float, float]
    """of the clutter"""
    blockers: int
    """of them stand on the line from the robot to the target"""
    count: tuple[int, int] = (4, 8)
    """of the clutter"""
    apart_m: float = 0.01
    """least distance within the clutter"""


EASY = Difficulty(gap_m=0.045, spread_m=0.10, heights_m=(0.09, 0.15), blockers=0)
MEDIUM = Difficulty(gap_m=0.030, spread_m=0.030, heights_m=(0.17, 0.24), blockers=2)
"""as tall as the hard ones, with room for a learner: of its episodes alone a policy of 60 clean
demonstrations topples something in a fifth, in the hard ones in half"""
HARD = Difficulty(gap_m=0.022, spread_m=0.015, heights_m=(0.17, 0.24), blockers=2)


@dataclass(frozen=True)
class Scene:
    """The target, then the clutter."""

    target: StandingObject
    clutter: tuple[StandingObject, ...]

    @property
    def objects(self) -> tuple[StandingObject, ...]:
        """All objects, the target first."""
        return (self.target, *self.clutter)


def draw_scene(rng: np.random.Generator, difficulty: Difficulty) -> Scene:
    """A scene of that difficulty; whether a robot can solve it is for others to say."""
    while True:
        target = _draw_target(rng)
        count = int(rng.integers(difficulty.count[0], difficulty.count[1] + 1))
        kinds = rng.permutation([kind for kind, many in POOL.items() for _ in range(many)])
        clutter: list[StandingObject] = []
        for number, kind in enumerate(kinds[:count]):
            placed = _place(rng, difficulty, target, clutter, Kind(kind), number)
            if placed is None:
                break
            clutter.append(placed)
        if len(clutter) == count:
            return Scene(target, tuple(clutter))


def _draw_target(rng: np.random.Generator) -> StandingObject:
    distance, azimuth = rng.uniform(0.38, 0.54), rng.uniform(-0.5, 0.5)
    radius = float(rng.uniform(0.026, 0.033))
    return StandingObject(
        kind=Kind.CAN,
        half_x_m=radius,
        half_y_m=radius,
        height_m=float(rng.uniform(0.10, 0.14)),
        mass_kg=float(rng.uniform(0.12, 0.30)),
        x_m=float(distance * np.cos(azimuth)),
        y_m=float(distance * np.sin(azimuth)),
        yaw_rad=0.0,
        rgba=TARGET_RGBA,
    )


def _shape(rng: np.random.Generator, difficulty: Difficulty, kind: Kind) -> StandingObject:
    half_x = float(rng.uniform(0.024, 0.034))
    half_y = float(rng.uniform(0.024, 0.034)) if kind is Kind.BOX else half_x
    return StandingObject(
        kind=kind,
        half_x_m=half_x,
        half_y_m=half_y,
        height_m=float(rng.uniform(*difficulty.heights_m)),
        mass_kg=float(rng.uniform(0.15, 0.35)),
        x_m=0.0,
        y_m=0.0,
        yaw_rad=float(rng.uniform(0, np.pi / 2)) if kind is Kind.BOX else 0.0,
        rgba=_PALETTE[int(rng.integers(len(_PALETTE)))],
    )


def _place(
    rng: np.random.Generator,
    difficulty: Difficulty,
    target: StandingObject,
    clutter: list[StandingObject],
    kind: Kind,
    number: int,
) -> StandingObject | None:
    shape = _shape(rng, difficulty, kind)
    to_robot = np.arctan2(-target.y_m, -target.x_m)
    blocks = number < difficulty.blockers
    for tries in range(_TRIES):
        # Who finds no place near the target stands farther away: a second blocker behind the first.
        spread = difficulty.spread_m + _STEP_BACK_M * tries
        gap = difficulty.gap_m + rng.uniform(0, spread)
        angle = to_robot + rng.uniform(-0.35, 0.35) if blocks else rng.uniform(-np.pi, np.pi)
        # A box is kept at a distance as if it were the circle around it.
        away = target.half_x_m + gap + shape.reach_m
        placed = replace(
            shape,
            x_m=float(target.x_m + away * np.cos(angle)),
            y_m=float(target.y_m + away * np.sin(angle)),
        )
        if _fits(placed, clutter, difficulty.apart_m):
            return placed
    return None


def _fits(placed: StandingObject, clutter: list[StandingObject], apart_m: float) -> bool:
    # Inside the table by a hand's breadth, and clear of the robot's foot.
    if not TABLE_X_M[0] + 0.07 < placed.x_m < TABLE_X_M[1] - 0.07:
        return False
    if not TABLE_Y_M[0] + 0.07 < placed.y_m < TABLE_Y_M[1] - 0.07:
        return False
    return all(
        np.hypot(placed.x_m - other.x_m, placed.y_m - other.y_m)
        >= placed.reach_m + other.reach_m + apart_m
        for other in clutter
    )
