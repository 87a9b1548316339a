"""Actions in words: what a policy wants, and what experts did instead."""

import numpy as np
from numpy.typing import NDArray

from sheath_manip.types import ActionSpec

ALIKE = 0.1
"""share of a dimension's range by which two actions may differ and count as the same, where the
task does not say"""
_UNITS = {"rad_per_s": "rad/s", "m_per_s": "m/s", "rad": "rad", "m": "m", "n": "N", "s": "s"}


def quantity(name: str) -> tuple[str, str]:
    """Return the words and the unit of a dimension such as `steering_rad`; no unit is empty."""
    for suffix, unit in _UNITS.items():
        if name.endswith(f"_{suffix}"):
            return name.removesuffix(f"_{suffix}").replace("_", " "), unit
    return name.replace("_", " "), ""


def amount(name: str, value: float) -> str:
    """Return such as `steering +0.26 rad`."""
    words, unit = quantity(name)
    return f"{words} {value:+.2f} {unit}".rstrip()


def wish(spec: ActionSpec, action: NDArray) -> str:
    """Return what follows `to`, such as `go left`, of one of the choices of a discrete space."""
    assert spec.choices is not None
    place = int(np.abs(spec.choices - action).sum(axis=1).argmin())
    if spec.choice_words:
        return spec.choice_words[place]
    chosen = spec.choices[place]
    if np.isin(spec.choices, (0.0, 1.0)).all():
        pressed = [quantity(name)[0] for name, on in zip(spec.names, chosen, strict=True) if on]
        return f"press {' and '.join(pressed) or 'nothing'}"
    told = (amount(name, float(each)) for name, each in zip(spec.names, chosen, strict=True))
    return f"do {', '.join(told)}"


def same(spec: ActionSpec, actions: NDArray, action: NDArray) -> NDArray[np.bool_]:
    """(k,) which of (k, a) `actions` count as the same as (a,) `action`."""
    share = 0.0 if spec.choices is not None else spec.tolerance or ALIKE
    return np.all(np.abs(actions - action) <= share * spec.span + 1e-6, axis=1)
