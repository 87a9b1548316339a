"""What a person may order, by the page's buttons, its hotkeys or a websocket."""

import math
from enum import StrEnum

SLOWEST, FASTEST = 0.1, 4.0
"""times the task's own pace"""


class Order(StrEnum):
    """One order; the values are what goes over the wire."""

    PAUSE = "pause"
    RESUME = "resume"
    STEP = "step"
    """one control step of a paused run"""
    SPEED = "speed"
    """comes with a number, 1 for the task's own pace"""
    TAKE_OVER = "take-over"
    HAND_BACK = "hand-back"
    """who drives lets the policy go on; anyone, where who drove was lost and nobody drives"""
    STOP = "emergency-stop"
    """latched; anyone may give it, at any time"""
    RESET = "reset-stop"
    """ends the emergency stop that its giver has seen, no newer one, and leaves the run paused: a
    reset by itself moves nothing"""
    SUCCESS = "mark-success"
    """ends the episode, as all that follow"""
    FAILURE = "mark-failure"
    SAVE = "save"
    """with the outcome that it has"""
    DISCARD = "discard"
    """records nothing, and runs the scene again, unless it is called off within a few seconds"""
    CALL_OFF = "call-off-discard"
    """goes on with the episode that was to be discarded"""
    CHOOSE = "choose-robot"
    """of several robots; comes with its number"""
    NEXT = "next-robot"
    """the one that asks most urgently beside the one that is shown"""


OF_ANY_RUN = (Order.PAUSE, Order.RESUME, Order.STEP, Order.SPEED)
"""also where nobody may drive"""


def clamped_speed(value: float) -> float:
    """`value` within what a run may be paced at; 1 where it is no number."""
    return min(max(value, SLOWEST), FASTEST) if math.isfinite(value) else 1.0
