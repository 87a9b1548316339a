"""What the tests of gated environments share: the corridor, learned in a moment, and its gates."""

from functools import cache

from sheath_manip.gates.config import GateConfig
from sheath_manip.gates.fitted import FittedGate, Sources
from sheath_manip.learning.checkpoint import Checkpoint
from sheath_manip.learning.first_episodes import demonstrations
from sheath_manip.learning.fitting import fit_gate
from sheath_manip.policies import make_policy
from sheath_manip.types.samples import samples_from
from tests.toy import CORRIDOR, Corridor


@cache
def checkpoint(policy: str = "hog-svm", embedding: str = "features", **settings) -> Checkpoint:
    """A policy of four demonstrations and a gate of three more."""
    episodes = demonstrations(CORRIDOR, 7)
    states = samples_from(episodes[:4])
    fitted = make_policy(policy, Corridor().spec, seed=0, **settings).fit(states)
    config = GateConfig(signal="support", embedding=embedding)
    held_out = [samples_from([each]) for each in episodes[4:]]
    gate: FittedGate = fit_gate(fitted, states, held_out, config, sources=Sources()).gate
    return Checkpoint("corridor", policy, fitted, gate)


def looking_checkpoint() -> Checkpoint:
    """One whose gate judges by what a network saw."""
    return checkpoint("cnn", "penultimate", channels=(8,), hidden=(16,), epochs=8)
