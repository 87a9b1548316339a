"""Random stages: a profile of column heights with enemies on its flat parts."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError
from sheath_manip.tasks.platformer.enemies import MOST_ENEMIES, Enemy

LENGTH_TILES = 220
"""from where the player starts (x = 0) to the flag"""
LEAD_TILES = 14
"""columns before x = 0, so that a column's index is floor(x) + LEAD_TILES"""
TRAIL_TILES = 14
"""behind the flag"""
_WALL_TILES, _WALL_HEIGHT = 4, 16
"""at the left end, which nobody can jump"""
_SAFE_TILES = 8
"""at the start and before the flag: flat and without enemies"""
_GROUND = 3
"""height of start and finish; the profile stays within 2 .. 7"""
_LOWEST, _HIGHEST = 2, 7
_PIPE_TILES = 2
_ENEMY_SHARES = 0.1, 0.2
"""of the flat stretches with an enemy: at difficulty 0, and more for each one above. At 1 a policy
cloned from two demonstrations comes a third of the way, DAgger's half the way after ten rounds
(50 stages). With an enemy on every other stretch all methods came less far: on six tuning stages
DAgger's policies 76-86 tiles in place of 118, mean of ten rounds"""


@dataclass(frozen=True)
class Block:
    """A run of columns of one height: a box of the physics. Everything in tiles (metres)."""

    left: float
    right: float
    height: float
    pipe: bool = False
    """narrow and higher than what is beside it: only looks different"""


@dataclass(frozen=True, eq=False)
class Stage:
    """What one episode is played on."""

    heights: NDArray[np.int16]
    """(columns,) tiles of ground in each column, 0 in a gap"""
    blocks: tuple[Block, ...]
    """the ground in as few boxes as possible: where two meet, their heights differ"""
    enemies: tuple[Enemy, ...]

    def enemies_around(self, behind: int, ahead: int) -> list[tuple[int, ...]]:
        """Return by column the enemies that may come so many tiles near to a player in it."""
        around: list[list[int]] = [[] for _ in self.heights]
        for index, enemy in enumerate(self.enemies):
            first = int(enemy.left_m) + LEAD_TILES - ahead
            last = int(enemy.right_m) + LEAD_TILES + behind
            for column in around[max(first, 0) : last + 1]:
                column.append(index)
        return [tuple(column) for column in around]


def draw_stage(rng: np.random.Generator, difficulty: int) -> Stage:
    """A stage that a player at full speed can finish; harder ones are denser, never longer."""
    if difficulty < 0:
        raise ParameterError(f"difficulty {difficulty}; wanted 0 or more")
    # One draw for all: numbers one by one would cost more than all the rest of a stage.
    draws = iter(rng.random(3 * LENGTH_TILES).tolist())
    profile = [_WALL_HEIGHT] * _WALL_TILES
    profile += [_GROUND] * (LEAD_TILES - _WALL_TILES + _SAFE_TILES)
    finish = LEAD_TILES + LENGTH_TILES - _SAFE_TILES
    while len(profile) < finish:
        profile += _piece(profile[-1], difficulty, draws)
    # The last piece may be a gap or a pipe: what it would leave of itself is flat ground.
    profile = profile[:finish] + [_GROUND] * (_SAFE_TILES + TRAIL_TILES)
    runs = list(_runs(profile))
    return Stage(
        np.array(profile, np.int16),
        tuple(block for block in runs if block.height > 0),
        tuple(_enemies(runs, difficulty, draws))[:MOST_ENEMIES],
    )


def _between(low: int, high: int, draw: float) -> int:
    return low + int(draw * (high - low + 1))


def _piece(ground: int, difficulty: int, draws: Iterator[float]) -> list[int]:
    """Heights of an obstacle and of the flat ground behind it, which starts from `ground`."""
    flat = _between(max(5 - difficulty, 2), max(9 - difficulty, 4), next(draws))
    kind = next(draws)
    if kind < 0.35:
        width = _between(2, min(3 + difficulty, 6), next(draws))
        behind = _clipped(ground + _between(-1, 1, next(draws)))
        return [0] * width + [behind] * flat
    if kind < 0.6:
        rise = _between(2, 3, next(draws))
        return [ground + rise] * _PIPE_TILES + [ground] * flat
    if kind < 0.75:
        # Stairs up to a ledge.
        rise = _between(2, 3, next(draws))
        stairs = [_clipped(ground + step) for step in range(1, rise + 1)]
        return [height for height in stairs for _ in range(2)] + [stairs[-1]] * flat
    step = _between(1, 3, next(draws))
    up = next(draws) < 0.5 if _LOWEST < ground < _HIGHEST else ground == _LOWEST
    return [_clipped(ground + (step if up else -step))] * flat


def _clipped(height: int) -> int:
    return min(max(height, _LOWEST), _HIGHEST)


def _runs(profile: list[int]) -> Iterator[Block]:
    left = 0
    for height, run in groupby(profile):
        right = left + len(list(run))
        beside = profile[max(left - 1, 0)], profile[min(right, len(profile) - 1)]
        pipe = right - left == _PIPE_TILES and height >= max(beside) + 2
        yield Block(float(left - LEAD_TILES), float(right - LEAD_TILES), float(height), pipe)
        left = right


def _enemies(runs: list[Block], difficulty: int, draws: Iterator[float]) -> Iterator[Enemy]:
    """One for each stretch of flat ground that is drawn, from left to right."""
    share = min(_ENEMY_SHARES[0] + _ENEMY_SHARES[1] * difficulty, 0.9)
    for run in runs:
        left = max(run.left, float(_SAFE_TILES))
        right = min(run.right, float(LENGTH_TILES - _SAFE_TILES))
        if run.height == 0 or right - left < 4:
            continue
        for part in range(int((right - left) // 6) or 1):
            if next(draws) < share:
                width = min(right - left - 6 * part, 7.0)
                start = left + 6 * part
                hops = next(draws) < 0.3
                yield Enemy(start + 0.5, start + width - 0.5, run.height, hops, next(draws))
