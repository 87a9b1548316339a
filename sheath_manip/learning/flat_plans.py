"""Plans in files of before 0.2, when a plan was one flat table of settings, in today's shape."""

from collections.abc import Mapping
from typing import Any

from sheath_manip.exceptions import ParameterError
from sheath_manip.files.json_files import plain
from sheath_manip.learning.config import LearningPlan

PLACES: dict[str, tuple[str, ...]] = {
    "policy": ("policy", "name"),
    "policy_settings": ("policy", "settings"),
    "signal": ("gate", "signal"),
    "embedding": ("gate", "embedding"),
    "precedent_embedding": ("gate", "precedent_embedding"),
    "support": ("gate", "support", "name"),
    "nu": ("gate", "support", "nu"),
    "bandwidth_factor": ("gate", "support", "bandwidth_factor"),
    "bandwidth_unit": ("gate", "support", "bandwidth_unit"),
    "threshold_rule": ("gate", "threshold", "rule"),
    "false_alarm_rate": ("gate", "threshold", "false_alarm_rate"),
    "expert_budget": ("gate", "threshold", "expert_budget"),
    "recalibrate": ("gate", "threshold", "recalibrate"),
    "release_rate": ("gate", "release_rate"),
    "release_margin": ("gate", "release_margin"),
    "quiet_steps": ("gate", "quiet_steps"),
    "minimum_hold_steps": ("gate", "minimum_hold_steps"),
    "demonstrations": ("schedule", "demonstrations"),
    "demonstration_noise": ("schedule", "demonstration_noise"),
    "calibration": ("schedule", "calibration"),
    "check": ("schedule", "false_alarm_episodes"),
    "rounds": ("schedule", "rounds"),
    "episodes": ("schedule", "episodes"),
    "stop_below_loss": ("schedule", "stop_below_loss"),
    "beta": ("schedule", "beta"),
    "alpha": ("schedule", "alpha"),
    "variant": ("schedule", "variant"),
    "methods": ("comparison", "methods"),
    "seeds": ("comparison", "seeds"),
    "held_out": ("comparison", "evaluation_episodes"),
    "final": ("comparison", "final_episodes"),
    "final_variant": ("comparison", "final_variant"),
    "held_out_set": ("comparison", "held_out_set"),
}
"""by the flat name, where the setting stands now"""
DROPPED = ("refit_unused",)
"""settings that there are no more: no signal is fitted that no gate reads"""


def upgraded(content: Mapping[str, Any]) -> dict[str, Any]:
    """Return the content of a file with every plan in it in today's shape.

    What a flat plan does not say has its default, which is what held then.
    """
    if _is_flat(content):
        return _nested(content)
    return {
        name: upgraded(value) if isinstance(value, Mapping) else value
        for name, value in content.items()
    }


def _is_flat(content: Mapping[str, Any]) -> bool:
    return isinstance(content.get("policy"), str) and {"signal", "demonstrations"} <= set(content)


def _nested(content: Mapping[str, Any]) -> dict[str, Any]:
    nested = plain(LearningPlan().described())
    for name, value in content.items():
        if name in DROPPED:
            continue
        if name not in PLACES:
            raise ParameterError(f"unknown setting {name!r} in a plan of before; remove it")
        *path, last = PLACES[name]
        at = nested
        for part in path:
            at = at[part]
        at[last] = value
    return nested
