"""Who acts in a step, in words: one reading of a decision for banner, timeline and film."""

import numpy as np

from sheath_manip.types import Actor, Reason

FALLBACK = "fallback controller"
LEAST_DIGITS, MOST_DIGITS = 2, 6
"""after the point, where a number is written without a power of ten"""
_ACTS = {
    Actor.POLICY: "policy acts",
    Actor.EXPERT: "expert acts",
    Actor.OPERATOR: "operator acts",
    Actor.HOLD: "robot holds",
}
_BEFORE = {
    Reason.IDLE: Actor.HOLD,
    Reason.WAITING: Actor.HOLD,
    Reason.EMERGENCY_STOP: Actor.HOLD,
    Reason.NO_ANSWER: Actor.FALLBACK,
}
"""for which reasons the expert's turn was not the expert's own in recordings that know only policy
and expert"""


def actor_of(actor: Actor, reason: Reason) -> Actor:
    """Return who acted, also in recordings from before there were more than policy and expert."""
    return _BEFORE.get(reason, actor) if actor is Actor.EXPERT else actor


def actor_label(actor: Actor, reason: Reason, fallback: str = FALLBACK) -> str:
    """Return such as "policy acts"; `fallback` is who acts where no person came, in words."""
    return _ACTS.get(actor_of(actor, reason), f"{fallback} acts")


def actor_and_reason_label(actor: Actor, reason: Reason) -> str:
    """Return what a legend has: short, and with the reason where there is more than one."""
    who = actor_label(actor, reason).removesuffix(" acts")
    return f"{who}: {reason.value}" if actor is not Actor.POLICY and who != reason.value else who


def score_label(score: float, threshold: float) -> str:
    """Return such as "score 0.0219 ≥ -0.0021": with as many digits as tell the two apart."""
    sizes = [size for size in (abs(threshold), abs(score - threshold)) if size > 0]
    digits = 1 - int(np.floor(np.log10(min(sizes)))) if sizes else 0
    form = f".{max(digits, LEAST_DIGITS)}f" if digits <= MOST_DIGITS else ".3g"
    sign = "≥" if score >= threshold else "<"
    return f"score {score:{form}} {sign} {threshold:{form}}"
