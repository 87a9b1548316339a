"""Turns a wish to open or close into the target of a gripper's servo."""

from dataclasses import dataclass

WIDTHS = 0.5
"""grips from minus to plus this hold a width; beyond, the gripper is opened or closed for good. Or
else a regressed -0.97 closes it a little, and nobody has demonstrated what to do then"""


@dataclass(frozen=True)
class ClosingControl:
    """Moves how far a gripper is to be closed at a speed that does not slam the fingers."""

    opening_m: float
    """how far it can close"""
    speed_m_s: float = 0.14
    squeeze_m: float = 0.022
    """how far the target may lead the fingers: beyond that the servo presses with all its force and
    it would take time to let go"""

    def target_m(self, target_m: float, closed_m: float, grip: float, timestep_s: float) -> float:
        """The servo's target (m closed) at the end of a control step that starts with `target_m`.

        `closed_m` is how far the fingers are closed; `grip` is -1 (open) .. 1 (closed), in between
        `WIDTHS` a width to hold.
        """
        share = 0.5 * (1.0 + min(max(grip / WIDTHS, -1.0), 1.0))
        wished = share * (self.opening_m + self.squeeze_m)
        step = self.speed_m_s * timestep_s
        led = min(max(target_m, closed_m - self.squeeze_m), closed_m + self.squeeze_m)
        return min(max(wished, led - step), led + step)

    def holding_grip(self, closed_m: float) -> float:
        """The grip that leaves the fingers where they are."""
        share = closed_m / (self.opening_m + self.squeeze_m)
        return WIDTHS * min(2 * share - 1, 1.0)
