"""How many injected faults were tried, how many the program survived, and how many it told of."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class Count:
    """Cases of one kind of fault."""

    tried: int = 0
    survived: int = 0
    """without a traceback, a hang, a lost recording or a silent change of data"""
    told: int = 0
    """of which something recorded or printed says what happened"""

    def __add__(self, other: "Count") -> "Count":
        return Count(
            self.tried + other.tried, self.survived + other.survived, self.told + other.told
        )

    @property
    def clean(self) -> bool:
        """Whether all that was tried was survived and told."""
        return self.tried == self.survived == self.told


@dataclass(frozen=True)
class Verdict:
    """What became of one case."""

    kind: str
    """of fault, in words: a row of the table in docs/reliability.md"""
    survived: bool
    told: bool
    case: str = ""
    """which one it was and what became of it, for who looks into it"""

    @property
    def count(self) -> Count:
        """This one case."""
        return Count(1, int(self.survived), int(self.told))


def counted(verdicts: Iterable[Verdict]) -> Mapping[str, Count]:
    """Return the counts by kind, in the order in which the kinds came."""
    counts: dict[str, Count] = {}
    for verdict in verdicts:
        counts[verdict.kind] = counts.get(verdict.kind, Count()) + verdict.count
    return counts
