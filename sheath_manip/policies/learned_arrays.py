"""Arrays that are taken over from a file, held against what they must be."""

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError
from sheath_manip.protocols import Arrays


def numbers(arrays: Arrays, name: str, *shape: int | None) -> NDArray:
    """Return the array `name`; None in `shape` is any length.

    Raises ParameterError where there is none, or one of another shape or of no numbers.
    """
    if name not in arrays:
        raise ParameterError(f"there is no array {name!r} among {', '.join(arrays) or 'none'}")
    array = np.asarray(arrays[name])
    lengths = zip(array.shape, shape, strict=False)
    fits = array.ndim == len(shape) and all(wanted in (None, has) for has, wanted in lengths)
    if not fits or array.dtype.kind not in "biuf":
        wanted = ", ".join("any" if length is None else str(length) for length in shape)
        raise ParameterError(
            f"{name} is {array.dtype} of shape {array.shape}; wanted numbers of shape ({wanted})"
        )
    return array


def require_shapes(arrays: Arrays, wanted: Mapping[str, tuple[int, ...]]) -> None:
    """Raise ParameterError unless the arrays have the wanted names and shapes, and are float32."""
    for name in wanted.keys() - arrays.keys():
        raise ParameterError(f"there is no array {name!r}")
    for name in arrays.keys() - wanted.keys():
        raise ParameterError(f"the array {name!r} belongs to none of the layers")
    for name, shape in wanted.items():
        if arrays[name].shape != shape or arrays[name].dtype != np.float32:
            raise ParameterError(
                f"{name} is {arrays[name].dtype} of shape {arrays[name].shape}; wanted float32 of "
                f"shape {shape} ({math.prod(shape)} numbers)"
            )
