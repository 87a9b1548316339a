"""Policies that stand in no table: of a file, of a module, or in a directory of LeRobot's."""

import sys
from pathlib import Path
from typing import Any

from sheath_manip.cli.own_modules import module_at
from sheath_manip.exceptions import RegistrationError, SetupError, SheathError, UnknownNameError
from sheath_manip.protocols import PredictingPolicy
from sheath_manip.types import ActionSpec

LEROBOT = "lerobot:"
WANTED = "wanted file.py:POLICY, module:attribute or lerobot:DIR"
METHODS = ("reset", "propose", "predict", "surrogate_losses")


def policy_named(name: str, action: ActionSpec | None = None) -> PredictingPolicy:
    """Import and return the policy that `name` says, `mine.py:act` or `lerobot:DIR`.

    A torch module is wrapped by `from_torch`, any other callable by `from_callable`.

    Args:
        name: where it is.
        action: the action space, as far as the data tells; None where it does not.

    Raises RegistrationError where it cannot be imported or is none, UnknownNameError where its file
    has nothing of that name, SetupError where LeRobot is not installed.
    """
    if name.startswith(LEROBOT):
        return _of_lerobot(name.removeprefix(LEROBOT))
    place, _, attribute = name.rpartition(":")
    if not (place and attribute):
        raise RegistrationError(f"{name!r} does not say where a policy is; {WANTED}")
    found: Any = module_at(place, WANTED)
    for part in attribute.split("."):
        if not hasattr(found, part):
            offered = [each for each in vars(found) if not each.startswith("_")]
            raise UnknownNameError(f"name in {place}", part, offered)
        found = getattr(found, part)
    return _as_policy(name, found, action)


def _of_lerobot(directory: str) -> PredictingPolicy:
    try:
        # Only now: it wants a package that few have.
        from sheath_manip.adapters.lerobot import load_policy
    except ImportError as error:
        raise SetupError(
            f"LeRobot's policies want the package lerobot ({error}); install it with "
            "`pip install 'sheath-manip[lerobot]'`"
        ) from error
    try:
        return load_policy(Path(directory))
    except SheathError:
        raise
    except Exception as error:
        # Packages that do not belong together fail in ways of their own while they are imported.
        reason = " ".join(str(error).split())[:300]
        raise RegistrationError(
            f"LeRobot cannot load {directory} ({type(error).__name__}: {reason})"
        ) from error


def _as_policy(name: str, found: Any, action: ActionSpec | None) -> PredictingPolicy:
    if isinstance(found, type):
        raise RegistrationError(
            f"{name} is the class {found.__name__}; wanted an object of it, as "
            f"POLICY = {found.__name__}(…)"
        )
    if all(hasattr(found, method) for method in METHODS):
        return found
    torch = sys.modules.get("torch")
    if torch is not None and isinstance(found, torch.nn.Module):
        from sheath_manip.adapters.from_torch import from_torch

        return from_torch(found, action=action)
    if callable(found):
        from sheath_manip.adapters.from_callable import from_callable

        return from_callable(found, action=action)
    lacking = [method for method in METHODS if not hasattr(found, method)]
    raise RegistrationError(
        f"{name} is of type {type(found).__name__} and lacks {', '.join(lacking)}; wanted a "
        "policy, or a function of one observation: docs/own/frozen-policy.md"
    )
