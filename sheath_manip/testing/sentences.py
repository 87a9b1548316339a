"""What the suites say of a member: a sentence for each thing that the contract wants."""

from collections.abc import Callable, Mapping
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import SheathError

Numbers = NDArray[Any]
T = TypeVar("T")


def wants(holds: bool, sentence: str) -> None:
    """Raise AssertionError with the sentence where it does not hold."""
    if not holds:
        raise AssertionError(sentence)


def wants_a(kind: type[T], found: object, what: str) -> T:
    """Return `found`, which `what` gave and which must be of that kind."""
    wants(isinstance(found, kind), f"{what} gave a {_kind(found)}; wanted a {kind.__name__}")
    return found  # pyright: ignore[reportReturnType]


def wants_equal(found: Numbers, wanted: Numbers, sentence: str) -> None:
    """Raise AssertionError where two arrays differ in a bit; NaN is equal to NaN."""
    same = found.shape == wanted.shape and np.array_equal(
        found, wanted, equal_nan=found.dtype.kind == "f"
    )
    wants(same, sentence)


def wants_close(found: Numbers, wanted: Numbers, sentence: str, tolerance: float = 1e-4) -> None:
    """Raise AssertionError where two arrays differ by more than `tolerance`."""
    same = found.shape == wanted.shape and np.allclose(
        found, wanted, rtol=tolerance, atol=tolerance, equal_nan=True
    )
    wants(same, sentence)


def wants_arrays(member: Any) -> Mapping[str, Numbers]:
    """Return the member's learned state, which must be plain arrays by name."""
    arrays = member.arrays()
    for name, array in arrays.items():
        wants(
            isinstance(name, str)
            and isinstance(array, np.ndarray)
            and array.dtype.kind in "biufUS",
            f"{_kind(member)}.arrays() has {name!r}, a {type(array).__name__}; wanted plain numpy "
            "arrays by name, without Python objects",
        )
    return arrays


def wants_stored_hyperparameters(member: Any) -> None:
    """Check that the constructor kept every argument under its own name, but for the spec."""
    import inspect

    for name in inspect.signature(type(member)).parameters:
        wants(
            name == "spec" or hasattr(member, name),
            f"{_kind(member)} does not keep its argument {name!r} under that name, so that a "
            "checkpoint could not make it again",
        )


def wants_refusal(act: Callable[[], Any], sentence: str) -> None:
    """Check that `act` raises one of the errors of this framework, in one line."""
    try:
        act()
    except SheathError as error:
        wants("\n" not in str(error), f"{sentence}; its error has more than one line: {error}")
        return
    except Exception as error:
        raise AssertionError(
            f"{sentence}; wanted a ParameterError, got {type(error).__name__}: {error}"
        ) from error
    raise AssertionError(sentence)


def _kind(member: Any) -> str:
    return type(member).__name__
