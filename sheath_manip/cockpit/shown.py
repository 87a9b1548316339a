"""What somebody saw who gives an order: what has changed since then may make it void."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Shown:
    """What was shown where an order was given; None of what is not said."""

    stops: int | None = None
    """the number of the newest emergency stop: a reset clears no other, and an order to move is
    void where there was a newer one"""
    robot: int | None = None
    """the number of the robot, where there are several: an order is for no other"""
    episode: int | None = None
    """the number of the episode: an order to end it ends no later one"""


NOTHING = Shown()
