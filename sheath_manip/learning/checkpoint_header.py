"""What a checkpoint's header must hold, and of which type, before anything is made of it."""

import math
from collections.abc import Mapping
from typing import Any

from sheath_manip.gates.blocks import BlocksConfig
from sheath_manip.gates.config import GateConfig

FACTS: Mapping[str, Any] = {
    "task": "",
    "policy": {"name": "", "hyper": {}},
    "has_signal": False,
    "threshold": 0.0,
    "release_margin": 0.0,
    "sources": {"fitted_to": [""], "held_out": [""]},
    "method": "",
    "round": 0,
    "run_seed": 0,
    "training_loss": 0.0,
}
"""each fact with a value of its type; a list is of any length"""
EXAMPLE = GateConfig(blocks=BlocksConfig(0.1, (1,))).described()
"""a gate's settings, in each list a value of its type"""
MOST_DEEP = 6
MOST_ENTRIES = 1000
"""in a list or a mapping of hyperparameters"""


def require_header(header: Mapping[str, Any]) -> None:
    """Raise ValueError for the first fact that is missing, of another type or no finite number.

    The loss may be no number, and so may the threshold of a gate that looks at no signal.
    """
    for name, example in FACTS.items():
        if name not in header:
            raise ValueError(f"the header says nothing of {name}")
        _require_like(name, header[name], example)
    for name in ("name", "hyper"):
        if name not in header["policy"]:
            raise ValueError(f"the header says nothing of the policy's {name}")
    if set(header["sources"]) != set(FACTS["sources"]):
        raise ValueError("sources: wanted fitted_to and held_out")
    _require_like("gate", header.get("gate"), EXAMPLE)
    _require_finite("gate", header["gate"])
    _require_plain("policy.hyper", header["policy"]["hyper"], MOST_DEEP)
    if header["has_signal"] and math.isnan(header["threshold"]):
        raise ValueError("threshold is NaN; wanted a number, since its gate looks at a signal")
    if not 0 <= header["release_margin"] < math.inf:
        raise ValueError(f"release_margin is {header['release_margin']}; wanted 0 or more")


def _require_like(where: str, value: Any, example: Any) -> None:
    """Raise ValueError where a value is of another type than its example."""
    if isinstance(example, float):
        fits = isinstance(value, int | float) and not isinstance(value, bool)
    else:
        fits = type(value) is type(example)
    if not fits:
        raise ValueError(f"{where} is {value!r:.60}; wanted {type(example).__name__}")
    if isinstance(value, dict) and isinstance(example, dict):
        for name in value.keys() & example.keys():
            _require_like(f"{where}.{name}", value[name], example[name])
    elif isinstance(value, list) and isinstance(example, list):
        for each in value:
            _require_like(where, each, example[0])
    elif isinstance(value, int) and abs(value) >= 2**64:
        raise ValueError(f"{where} is a number of {value.bit_length()} bits; wanted at most 64")


def _require_finite(where: str, value: Any) -> None:
    if isinstance(value, dict):
        for name, each in value.items():
            _require_finite(f"{where}.{name}", each)
    elif isinstance(value, float) and not math.isfinite(value):
        raise ValueError(f"{where} is {value}; wanted a finite number")


def _require_plain(where: str, value: Any, deep: int) -> None:
    """Raise ValueError for hyperparameters that no constructor of ours would ask for."""
    if isinstance(value, dict | list):
        if deep == 0 or len(value) > MOST_ENTRIES:
            raise ValueError(
                f"{where} holds {len(value)} values, nested deep; wanted at most {MOST_ENTRIES}, "
                f"{MOST_DEEP} deep"
            )
        inside = value.items() if isinstance(value, dict) else enumerate(value)
        for name, each in inside:
            _require_plain(f"{where}.{name}", each, deep - 1)
    elif isinstance(value, int) and abs(value) >= 2**64:
        raise ValueError(f"{where} is a number of {value.bit_length()} bits; wanted at most 64")
    else:
        _require_finite(where, value)
