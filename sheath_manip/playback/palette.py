"""One look for each meaning, the same on the page, in films and in figures.

Two families that never stand for each other: those who act, and the methods that are compared.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache

from sheath_manip.types import Actor, Outcome, Reason

Rgb = tuple[int, int, int]


@dataclass(frozen=True)
class Look:
    """How a method is drawn: by colour, and for those who see none by marker and dashes."""

    rgb: Rgb
    marker: str
    """as matplotlib calls it"""
    dashes: tuple[float, ...] = ()
    """lengths drawn and left out, in line widths; none for a whole line"""


# Blue, vermillion, green and yellow as Okabe and Ito have them, which colour-blind readers can tell
# apart; the green is lighter, so that each differs in lightness as well (tests/playback).
ACTOR: dict[Actor, Rgb] = {
    Actor.POLICY: (0, 114, 178),
    Actor.EXPERT: (213, 94, 0),
    Actor.OPERATOR: (0, 172, 126),
    Actor.FALLBACK: (213, 94, 0),
    Actor.HOLD: (240, 228, 66),
}
REASON: dict[Reason, Rgb] = {
    Reason.OUTSIDE: (213, 94, 0),
    Reason.RISK: (150, 60, 130),
    Reason.HOLD: (240, 175, 120),
    Reason.SPARED: (245, 205, 165),
    Reason.STUCK: (120, 90, 60),
    Reason.PERSON: (0, 172, 126),
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
WHITE: Rgb = (255, 255, 255)
BLACK: Rgb = (0, 0, 0)
GREY: Rgb = (110, 116, 124)
PALE: Rgb = (217, 220, 225)
PAPER: Rgb = (246, 247, 249)

# Those of the house have a look of their own, whatever they are compared with. The first four also
# differ in lightness, from dark to light.
_METHODS: dict[str, Look] = {
    "sheath": Look((0, 84, 147), "o"),
    "dagger": Look((204, 82, 0), "s", (5, 1.5)),
    "cloning": Look((128, 134, 142), "D", (1.2, 1.2)),
    "random-takeover": Look((230, 170, 30), "^", (5, 1.5, 1.2, 1.5)),
    "sheath-own-labels": Look((86, 180, 233), "X", (2, 2)),
    "random-blocks": Look((0, 158, 115), "v", (3, 1)),
    "hg-dagger": Look((204, 121, 167), "P", (8, 2)),
    "sheath-plain": Look((122, 74, 30), "<", (5, 1.5, 1.2, 1.5, 1.2, 1.5)),
}
_OTHERS: tuple[Look, ...] = (
    Look(INK, "*", (1, 2)),
    Look((120, 80, 170), ">", (6, 1, 1, 1)),
    Look((140, 140, 40), "h", (4, 2)),
    Look((170, 60, 70), "p", (1, 1)),
    Look((0, 110, 130), "d", (7, 1.5, 1.2, 1.5)),
)


def methods(names: Iterable[str]) -> dict[str, Look]:
    """Return the look of each method, the same wherever the same methods are compared.

    In whatever order they come: a page learns of them as they begin.
    """
    listed = list(names)
    others = sorted({name for name in listed if name not in _METHODS})
    spare = {name: _OTHERS[index % len(_OTHERS)] for index, name in enumerate(others)}
    return {name: _METHODS.get(name) or spare[name] for name in listed}


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


@cache
def css(rgb: Rgb) -> str:
    """`rgb` as a page writes it."""
    return f"#{rgb[0]:02x}{rgb[1]:02x}{rgb[2]:02x}"


@cache
def readable_on(rgb: Rgb) -> Rgb:
    """Return white or black for letters on `rgb`: one of them has 4.58 to 1 or more (WCAG 2.2)."""
    return max(WHITE, BLACK, key=lambda letters: _contrast(rgb, letters))


def _contrast(one: Rgb, other: Rgb) -> float:
    light, dark = sorted((_luminance(one), _luminance(other)), reverse=True)
    return (light + 0.05) / (dark + 0.05)


def _luminance(rgb: Rgb) -> float:
    red, green, blue = (channel / 255 for channel in linear(rgb))
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue
