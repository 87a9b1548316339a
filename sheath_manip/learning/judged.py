"""What a round showed, while the policy that was fitted after it may still be at its scenes."""

import time
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Self

from sheath_manip.learning.results import RoundResult, read_result, write_result
from sheath_manip.metrics import EpisodeRecord
from sheath_manip.protocols import Report


@dataclass(frozen=True, eq=False)
class Measuring:
    """All that is known of a round but how its policy does alone."""

    known: RoundResult
    begin_s: float
    """of the measuring, by `time.perf_counter`"""
    policy: Iterable[EpisodeRecord]
    """of the policy alone; an executor whose requests overlap is at these episodes already"""
    final: Iterable[EpisodeRecord]
    """of the last policy on the final scenes"""

    def result(self) -> RoundResult:
        """Wait for the episodes, or run them now, and return the whole."""
        policy, final = tuple(self.policy), tuple(self.final)
        wall_s = time.perf_counter() - self.begin_s
        return replace(self.known, policy=policy, final=final, wall_s=wall_s)


@dataclass(frozen=True, eq=False)
class Judged:
    """A round whose result is on the disk, or will be."""

    path: Path
    """of the result"""
    number: int
    """of the round"""
    last: bool
    """whether no round follows"""
    measuring: Measuring | None
    """None: the result is there"""

    @classmethod
    def before(cls, path: Path) -> Self:
        """Return what an earlier run wrote; raises StoreError for a file that is no result."""
        result = read_result(path)
        return cls(path, result.round, bool(result.final), None)

    def finished(self, report: Report) -> RoundResult:
        """Return the result, which is on the disk then; `report` hears of what is not run again."""
        if self.measuring is not None:
            write_result(self.path, self.measuring.result())
        # Read back, so that a resumed run goes on with the same values.
        result = read_result(self.path)
        if self.measuring is None:
            for _ in (*result.policy, *result.final):
                report(f"{result.method} round {result.round}")
        return result
