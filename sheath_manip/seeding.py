"""Where randomness comes from: every generator and scene is named, so any run is repeatable."""

import hashlib

import numpy as np

from sheath_manip.types import Purpose


def generator(*keys: str | int) -> np.random.Generator:
    """A generator that depends on nothing but `keys`."""
    return np.random.default_rng(_digest(*keys))


def seed_for(*keys: str | int) -> int:
    """A 30-bit seed that depends on nothing but `keys`."""
    return _digest(*keys) % 2**30


def scene_seed(purpose: Purpose, *keys: str | int) -> int:
    """A 32-bit scene seed; its two highest bits are the purpose's, so no two purposes share one."""
    return list(Purpose).index(purpose) * 2**30 + seed_for("scene", *keys)


def _digest(*keys: str | int) -> int:
    text = "/".join(str(key) for key in keys)
    return int.from_bytes(hashlib.blake2b(text.encode(), digest_size=16).digest())
