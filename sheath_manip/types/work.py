"""What a program does while no episode runs, and how far the whole of it has come."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Work:
    """A piece of work that takes its time, and how far it is."""

    what: str
    """such as `fitting round 3`"""
    share: float | None = None
    """that is done, 0..1; None where nobody counts it"""


@dataclass(frozen=True)
class Headway:
    """How far a run of many units has come, such as the episodes and fits of an experiment."""

    done: int
    units: int
    left_s: float | None = None
    """that the rest takes, by what it took so far; None while that cannot be told"""
