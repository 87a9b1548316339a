"""Why a gate does not let the policy act, as values and as a sentence; nothing is drawn here."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sheath_manip.dashboard.action_words import quantity, same, wish
from sheath_manip.types import (
    Action,
    ActionSpec,
    Actor,
    GateDecision,
    Observation,
    Reason,
    SignalScore,
)
from sheath_manip.types.seen import Precedents

SUPPORT, MARGIN = "support", "margin"
"""signals that do not compare what the expert did"""
MILD = 0.05
"""share of held-out expert steps below a score that by itself would be no reason to ask"""
_WITHOUT_SCORE = {
    Reason.NO_SCORE: "The gate could not score this state, which counts as outside.",
    Reason.INVALID_PROPOSAL: "The policy proposed nothing that could be executed.",
    Reason.POLICY_FAILED: "The policy broke down.",
    Reason.GATE_FAILED: "The gate broke down.",
    Reason.TOO_LATE: "The policy's proposal, or the gate's leave, came too late.",
    Reason.STUCK: "The states are familiar, but nothing has moved for a while.",
    Reason.SPARED: "The policy might act again, but the next alarm would be one request too many.",
    Reason.HOLD: "The alarm is over; the expert drives on for a while.",
    Reason.PERSON: "A person has taken over.",
    Reason.EMERGENCY_STOP: "Somebody has stopped the robot.",
    Reason.WAITING: "The gate asks for another reason than its score.",
    Reason.NO_ANSWER: "The gate asked for another reason than its score.",
    Reason.DRAWN: "The gate draws at random who acts.",
    Reason.FIXED: "The gate goes by a schedule.",
}


@dataclass(frozen=True, eq=False)
class Moment:
    """A proposal in its state, and what the gate made of it."""

    observation: Observation
    proposed: Action | None
    labelled: Action | None
    """what the expert would do, where that is known"""
    decision: GateDecision

    @property
    def other(self) -> Actor:
        """Who `labelled` is of: the expert, or the person in its place."""
        return Actor.OPERATOR if self.decision.actor is Actor.OPERATOR else Actor.EXPERT


@dataclass(frozen=True, eq=False)
class Example:
    """A training state like the present one."""

    distance: float
    """1 is as far as a training state lies from the middle of them all"""
    did: str
    """what the expert did there, in words"""
    image: NDArray[np.uint8] | None
    """(h, w, 3) RGB; None where it cannot be read"""


@dataclass(frozen=True, eq=False)
class Explanation:
    """All that is shown of one moment."""

    sentence: str
    rang: str
    """the signal that is to blame; empty where none is"""
    moment: Moment
    precedents: Precedents | None = None
    """None where the gate compares with no single states, or is not known"""
    examples: tuple[Example, ...] = ()
    """the nearest of them"""
    lacks: str = ""
    """what is missing of all this, and why, in a sentence; empty where nothing is"""


def explained(
    moment: Moment, spec: ActionSpec, precedents: Precedents | None, held_out_steps: int = 0
) -> tuple[str, str]:
    """Return why the policy does not act at `moment`, in a sentence, and the signal that rang.

    Args:
        moment: with what its decision's score was made of.
        spec: of the actions.
        precedents: the training states nearest to it, as many as count as alike.
        held_out_steps: of the expert, that shares were taken of; 0 where that is not known.
    """
    decision = moment.decision
    below = not decision.score >= decision.threshold
    if decision.broken and not decision.signals:
        what = ", ".join(f"{each.who}: {each.what}" for each in decision.broken)
        return f"There is no proposal to judge, since something broke down ({what}).", ""
    if not decision.signals or decision.reason in (Reason.STUCK, Reason.INVALID_PROPOSAL):
        outside = "The score is below the threshold." if below else "The gate lets the policy act."
        return _WITHOUT_SCORE.get(decision.reason, outside), ""
    rarest = min(
        decision.signals, key=lambda each: (np.nan_to_num(each.share, nan=1.0), each.score)
    )
    if not below:
        if decision.reason in _WITHOUT_SCORE:
            return _WITHOUT_SCORE[decision.reason], ""
        rarity = _rarity(rarest, held_out_steps)
        return f"The gate lets the policy act. Rarest is the {rarest.signal}: {rarity}.", ""
    blamed = _blamed(rarest, moment, spec, precedents, held_out_steps)
    if rarest.share > MILD and len(decision.signals) > 1:
        return f"Several mild suspicions add up. {blamed}", rarest.signal
    return blamed, rarest.signal


def did(spec: ActionSpec, action: NDArray) -> str:
    """Return in a few words what was done."""
    if spec.choices is not None:
        return wish(spec, action)
    # Only what was done with some vigour: seven numbers nobody reads.
    share = np.abs(action) / spec.span
    most = np.argsort(-share)[:2]
    told = [f"{quantity(spec.names[at])[0]} {action[at]:+.2f}" for at in most if share[at] > 0.02]
    return ", ".join(told) or "hardly moved"


def _blamed(
    rang: SignalScore,
    moment: Moment,
    spec: ActionSpec,
    precedents: Precedents | None,
    held_out_steps: int,
) -> str:
    rarity = _rarity(rang, held_out_steps)
    if rang.signal == SUPPORT:
        return f"This state is unlike those that the policy was trained on: {rarity}."
    if rang.signal == MARGIN:
        return f"The policy can hardly decide between two actions: {rarity}."
    if precedents is None or moment.proposed is None:
        return f"The expert has hardly ever done what the policy wants in such a state: {rarity}."
    if spec.choices is not None:
        return f"{_against_choices(spec, precedents)}: {rarity}."
    return f"{_against_numbers(spec, precedents)}: {rarity}."


def _against_choices(spec: ActionSpec, precedents: Precedents) -> str:
    assert spec.choices is not None
    labels, wanted = precedents.labels, precedents.proposed
    counts = [int(same(spec, labels, each).sum()) for each in spec.choices]
    usual = spec.choices[int(np.argmax(counts))]
    agree = float(same(spec, labels, wanted).mean())
    most = max(counts) / len(labels)
    wants = f"The policy wants to {wish(spec, wanted)}"
    told = f"of the {len(labels)} expert steps in the states most like this one"
    if same(spec, usual[None], wanted)[0]:
        near = same(spec, labels[:1], wanted)[0]
        but = "even the nearest is far away" if near else "in the nearest it did otherwise"
        return f"{wants}; {told} {agree:.0%} did so, too, but {but}"
    return (
        f"{wants}; {told} {most:.0%} were to {wish(spec, usual)}, {agree:.0%} as the policy wants"
    )


def _against_numbers(spec: ActionSpec, precedents: Precedents) -> str:
    labels, wanted = precedents.labels, precedents.proposed
    low, middle, high = np.quantile(labels, (0.05, 0.5, 0.95), axis=0)
    beyond = np.maximum(low - wanted, wanted - high) / spec.span
    apart = np.abs(wanted - middle) / spec.span
    # What no expert did there says more than what is only unusual.
    at = int(np.argmax(np.where(beyond > 0, 1 + beyond, apart)))
    name, unit = quantity(spec.names[at])
    between = f"{low[at]:+.2f} and {high[at]:+.2f} {unit}".rstrip()
    return (
        f"The policy wants {name} {wanted[at]:+.2f}; of the {len(labels)} expert steps in the "
        f"states most like this one 90 % have it between {between}"
    )


def _rarity(score: SignalScore, held_out_steps: int) -> str:
    if np.isnan(score.share):
        return "how rare that is among expert steps is not known"
    if held_out_steps and score.share * held_out_steps < 100:
        lower = round(score.share * held_out_steps)
        steps = "none" if lower == 0 else f"{lower}"
        return f"of {held_out_steps:,} held-out expert steps {steps} scored lower"
    if score.share == 0:
        return "no held-out expert step scored lower"
    return f"{score.share:.1%} of held-out expert steps scored lower"
