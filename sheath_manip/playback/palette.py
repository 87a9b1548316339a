"""One colour for each meaning, the same in the panel, the score plot and the support picture."""

from sheath_manip.types import Actor, Outcome, Reason

Rgb = tuple[int, int, int]

# Blue, vermillion, purple and yellow of Okabe and Ito, which colour-blind readers can tell apart.
ACTOR: dict[Actor, Rgb] = {
    Actor.POLICY: (0, 114, 178),
    Actor.EXPERT: (213, 94, 0),
    Actor.OPERATOR: (0, 158, 115),
    Actor.FALLBACK: (213, 94, 0),
    Actor.HOLD: (240, 228, 66),
}
REASON: dict[Reason, Rgb] = {
    Reason.OUTSIDE: (213, 94, 0),
    Reason.RISK: (150, 60, 130),
    Reason.HOLD: (240, 175, 120),
    Reason.PERSON: (0, 158, 115),
    Reason.IDLE: (140, 205, 185),
    Reason.WAITING: (240, 228, 66),
    Reason.NO_ANSWER: (213, 94, 0),
    Reason.EMERGENCY_STOP: (190, 30, 45),
    Reason.NO_SCORE: (90, 40, 20),
    Reason.INVALID_PROPOSAL: (90, 40, 20),
    Reason.POLICY_FAILED: (90, 40, 20),
    Reason.GATE_FAILED: (90, 40, 20),
    Reason.ACTOR_FAILED: (190, 30, 45),
    Reason.ENVIRONMENT_FAILED: (190, 30, 45),
    Reason.TOO_LATE: (90, 40, 20),
}
"""why the policy does not act, where it is not for one of the gate's plain choices"""
OUTCOME: dict[Outcome, Rgb] = {
    Outcome.SUCCESS: (0, 135, 100),
    Outcome.FAILURE: (190, 30, 45),
    Outcome.TIME_LIMIT: (110, 116, 124),
    Outcome.ERROR: (90, 40, 20),
}
LIMITED: Rgb = (204, 121, 167)
SUPPORT: Rgb = (240, 228, 66)
INK: Rgb = (34, 39, 46)
GREY: Rgb = (110, 116, 124)


def linear(rgb: Rgb) -> Rgb:
    """`rgb` as viser's lines want it: as linear light (IEC 61966-2-1)."""
    red, green, blue = (
        round(255 * (c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4))
        for c in (channel / 255 for channel in rgb)
    )
    return red, green, blue


def turn(actor: Actor, reason: Reason) -> Rgb:
    """Return the colour of a step: who acted, and where that is not the policy, why."""
    if actor is Actor.POLICY:
        return ACTOR[Actor.POLICY]
    return REASON.get(reason, ACTOR[actor])


def css(rgb: Rgb) -> str:
    """`rgb` as a page writes it."""
    return f"#{rgb[0]:02x}{rgb[1]:02x}{rgb[2]:02x}"
