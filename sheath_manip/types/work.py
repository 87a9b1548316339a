"""What a program does while no episode runs."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Work:
    """A piece of work that takes its time, and how far it is."""

    what: str
    """such as `fitting round 3`"""
    share: float | None = None
    """that is done, 0..1; None where nobody counts it"""
