"""The settings of a gate for a policy that nobody here knows, until it is looked at."""

from sheath_manip.gates.config import GateConfig

SUITED = "suited"
"""in place of a signal or embedding: the one that suits policy and data"""
FROZEN = GateConfig(signal=SUITED, embedding=SUITED, precedent_embedding=SUITED)
"""the settings by default"""
