"""An arm by a cap with six axes, such as a SpaceMouse's."""

from sheath_manip.controllers.teleop.device import NOTHING, Motion, grip_of
from sheath_manip.types.operator_input import Given


class SixAxesDevice:
    """The cap springs back to its middle, which lets go of the dead-man."""

    def motion(self, given: Given) -> Motion:
        """Return the motion as the cap is pushed and turned."""
        axes = given.axes
        if axes is None:
            return NOTHING
        return Motion(axes.twist, grip_of(*axes.buttons), axes.held)
