"""The gate around LeRobot's policy, and who judged what."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from sheath_manip.gates.config import GateConfig
from sheath_manip.gates.fitted import FittedGate, Sources
from sheath_manip.learning.fitting import fit_to_looks, looks_of
from sheath_manip.policies.features import ScaledFeatures
from sheath_manip.protocols import Gate, PredictingPolicy
from sheath_manip.signals.near_precedent import NearPrecedentSignal
from sheath_manip.support.config import ThresholdConfig
from sheath_manip.types import Action, Actor, Episode, GateDecision, Observation, Proposal
from sheath_manip.types.samples import samples_from

FALSE_ALARM_RATE = 0.05
HOLD_STEPS = 10
"""half a second"""
CONFIG = GateConfig(
    signal="near-precedent",
    threshold=ThresholdConfig(false_alarm_rate=FALSE_ALARM_RATE),
    minimum_hold_steps=HOLD_STEPS,
)


OWN_LABELS = replace(CONFIG, labels="own")
"""learned from is what the expert itself did"""


def fitted_gate(
    policy: PredictingPolicy,
    learned: Sequence[Episode],
    held_out: Sequence[Episode],
    config: GateConfig = CONFIG,
) -> FittedGate:
    """Return a gate of features alone: nothing is asked of LeRobot's network but its actions."""
    signal = NearPrecedentSignal(ScaledFeatures())
    looks = looks_of(
        policy, signal, samples_from(learned), [samples_from([episode]) for episode in held_out]
    )
    return fit_to_looks(policy, signal, looks, config, sources=Sources())


def false_alarms(gate: FittedGate, fresh: Sequence[Episode]) -> float:
    """Return the share of an expert's new steps that alarm, each episode counting alike."""
    return float(
        np.mean([np.mean(gate.scores(samples_from([each])) < gate.threshold) for each in fresh])
    )


@dataclass
class Overheard:
    """A gate, and a note of each action that it was shown and left to the policy."""

    gate: Gate
    judged: list[Action | None] = field(default_factory=list)
    """None where somebody else acted"""

    def reset(self, rng: np.random.Generator) -> None:
        """Begin an episode."""
        self.judged = []
        self.gate.reset(rng)

    def decide(self, observation: Observation, proposal: Proposal | None) -> GateDecision:
        """Decide as the gate does."""
        decision = self.gate.decide(observation, proposal)
        shown = proposal is not None and decision.actor is Actor.POLICY
        self.judged.append(proposal.now[0].copy() if shown and proposal is not None else None)
        return decision
