"""Who is served first: the one order of all robots' requests, as a pure function.

1. What has waited for PATIENCE_S, the longest first: so that nobody waits for ever.
2. A robot whose driver was lost or stopped in the middle of a turn.
3. One whose policy or gate broke down, so that nothing is known of how bad it is.
4. One that a score speaks of (outside support, in-support risk): the farther below its threshold.
5. One that is stuck: nothing gets worse while it stands.
6. One that is held by a limit, or for another reason.

Among equals the one that has waited longest is first, then the one of the lower number. So where
a person serves the first of the queue, and takes at most T seconds from one hand-back to the next,
a request of one of N robots waits at most PATIENCE_S + N * T: before it is overdue anything may go
first, and afterwards only the one that is being served and those that were overdue before it.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass

from sheath_manip.types import Reason

PATIENCE_S = 60.0
"""after which a request goes before all that are younger"""
_BROKEN = (
    Reason.POLICY_FAILED,
    Reason.GATE_FAILED,
    Reason.INVALID_PROPOSAL,
    Reason.TOO_LATE,
    Reason.NO_SCORE,
    Reason.ACTOR_FAILED,
    Reason.ENVIRONMENT_FAILED,
)
_SCORED = (Reason.OUTSIDE, Reason.RISK)


@dataclass(frozen=True)
class Request:
    """What one robot asks."""

    number: int
    """of the robot"""
    waited_s: float
    reason: Reason | None = None
    """the gate's; None where it has none, and the robot asks all the same"""
    below: float = 0.0
    """by which its score is below the threshold, where there is one"""
    lost: bool = False
    """whether who drove it was lost or stopped"""

    @property
    def kind(self) -> int:
        """Its kind in the order above, less being overdue."""
        if self.lost:
            return 2
        if self.reason in _BROKEN:
            return 3
        if self.reason in _SCORED:
            return 4
        return 5 if self.reason is Reason.STUCK else 6


def by_urgency(requests: Iterable[Request], patience_s: float = PATIENCE_S) -> list[Request]:
    """Return the requests, the most urgent first."""

    def key(request: Request) -> tuple[float, ...]:
        if request.waited_s >= patience_s:
            return (1, -request.waited_s, request.number)
        # Not a number is no measure, and a finite one may be a great one.
        below = request.below if request.kind == 4 and not math.isnan(request.below) else 0.0
        return (request.kind, -below, -request.waited_s, request.number)

    return sorted(requests, key=key)
