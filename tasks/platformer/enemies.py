"""Enemies: each paces its stretch of ground, some of them hopping, as a function of time alone."""

from dataclasses import dataclass

MOST_ENEMIES = 40
"""on a stage: who lives is kept as the bits of one number, exact in a float64"""
PACE_M_S = 2.0
HALF_HEIGHT_M = 0.4
_HOP_PERIOD_STEPS, _HOP_STEPS = 32, 20
"""control steps from one hop to the next, and in the air"""
_HOP_HEIGHT_M = 2.2


@dataclass(frozen=True)
class Enemy:
    """Walks to and fro between two ends, for ever."""

    left_m: float
    """leftmost place of its centre"""
    right_m: float
    ground_m: float
    """height of the ground that it walks on"""
    hops: bool
    phase: float
    """0..1, where in its round it is at step 0"""

    def position(self, step: int) -> tuple[float, float]:
        """Return (x, z) of the enemy's centre, m, at a control step of 1/24 s."""
        span = self.right_m - self.left_m
        way = (2 * span * self.phase + PACE_M_S / 24 * step) % (2 * span)
        x = self.left_m + (way if way < span else 2 * span - way)
        z = self.ground_m + HALF_HEIGHT_M
        if self.hops:
            part = ((step + _HOP_PERIOD_STEPS * self.phase) % _HOP_PERIOD_STEPS) / _HOP_STEPS
            if part < 1:
                z += 4 * _HOP_HEIGHT_M * part * (1 - part)
        return x, z
