"""Errors that a user can act on; the command line prints each as one line and exits with code 2."""

from collections.abc import Iterable
from difflib import get_close_matches


class SheathError(Exception):
    """The root of all errors raised on purpose: what was wanted, what came, what would work."""


class UnknownNameError(SheathError):
    """A name that is in no table."""

    def __init__(self, kind: str, name: str, known: Iterable[str], otherwise: str = "") -> None:
        """Say what there is, and what is nearest; `otherwise` is said where nothing is near."""
        listed = sorted(known)
        near = get_close_matches(name, listed, n=1)
        meant = f"; did you mean {near[0]}?" if near else otherwise and f"; {otherwise}"
        super().__init__(f"unknown {kind} {name!r}; known: {', '.join(listed)}{meant}")


class RegistrationError(SheathError):
    """A member that a package gave by an entry point and that cannot be used."""


class ActionError(SheathError):
    """An action of the wrong shape, outside its bounds, or not finite."""


class ObservationError(SheathError):
    """What an environment shows is not what its spec says, or no number."""


class AttemptError(SheathError):
    """An episode was cut short: something broke down, and nobody was left to act."""


class CheckpointError(SheathError):
    """A checkpoint that is missing, broken, of an older schema, or of another task."""


class StoreError(SheathError):
    """A path that is no episode store, or an episode in it that cannot be read."""


class WorkerError(SheathError):
    """A worker process failed, or was lost."""


class ParameterError(SheathError):
    """A hyperparameter outside its range, or data of the wrong shape."""


class SetupError(SheathError):
    """Something that the machine lacks: a GL library, a free port, disk."""


class UnattendedError(SheathError):
    """Nobody can say what a simulation that cannot hold shall do after a stop or a loss."""


class UnscoredError(ParameterError):
    """So many states have no score that no threshold will do."""


class GateWarning(UserWarning):
    """A gate that was made as asked, and will not do what a gate is for."""
