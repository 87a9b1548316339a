"""Learned states within a learned state: each part's arrays under its own name."""

from collections.abc import Mapping

from sheath_manip.protocols import Arrays


def flatten(parts: Mapping[str, Arrays]) -> Arrays:
    """Return all arrays of all parts, each named `part/array`."""
    return {
        f"{name}/{key}": array for name, arrays in parts.items() for key, array in arrays.items()
    }


def subtree(arrays: Arrays, name: str) -> Arrays:
    """Return the arrays of one part, under their own names again."""
    start = f"{name}/"
    return {
        key.removeprefix(start): array for key, array in arrays.items() if key.startswith(start)
    }
