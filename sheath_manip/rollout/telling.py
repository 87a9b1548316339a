"""What broke down is said once, in a line, not at every step."""

import logging

from sheath_manip.types import Breakdown, EpisodeInfo, GateDecision

logger = logging.getLogger(__name__)


class Telling:
    """Logs the breakdowns of an episode, each kind once."""

    def __init__(self, info: EpisodeInfo) -> None:
        self._where = f"{info.method or info.purpose} round {info.round} episode {info.index}"
        self._told: set[Breakdown] = set()

    def hush(self, breakdown: Breakdown) -> None:
        """Say nothing of what is told of elsewhere."""
        self._told.add(breakdown)

    def tell(self, step: int, decision: GateDecision) -> None:
        """Say what broke down in a step, and who acts."""
        for each in decision.broken:
            if each not in self._told:
                self._told.add(each)
                logger.warning(
                    "%s, step %d: %s: %s; %s: %s acts (the same again in this episode is only "
                    "recorded)",
                    self._where,
                    step,
                    each.who,
                    each.what,
                    decision.reason,
                    decision.actor,
                )
