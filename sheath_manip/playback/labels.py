"""Who acts in a step, in words: one reading of a decision for banner, timeline and film."""

from sheath_manip.cockpit.cockpit import State
from sheath_manip.types import Reason

_HOLDS = "robot holds"
_OTHERS = {
    Reason.PERSON: "person acts",
    Reason.IDLE: _HOLDS,
    Reason.WAITING: _HOLDS,
    Reason.EMERGENCY_STOP: _HOLDS,
}
"""where the expert's turn is not the expert's own"""


def acting(by_expert: bool, reason: Reason, stand_in: str = State.stand_in) -> str:
    """Such as "policy acts"; `stand_in` is who acts where no person came."""
    if not by_expert:
        return "policy acts"
    if reason is Reason.NO_ANSWER:
        return f"{stand_in} acts"
    return _OTHERS.get(reason, "expert acts")


def acting_and_why(by_expert: bool, reason: Reason) -> str:
    """As a legend has it: short, and with the reason where there is more than one."""
    who = acting(by_expert, reason).removesuffix(" acts")
    return f"{who}: {reason.value}" if by_expert and who != reason.value else who
