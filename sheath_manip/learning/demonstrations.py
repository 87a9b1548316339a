"""Which recorded episodes are learned from: a failure of the expert is no demonstration."""

from collections import Counter
from collections.abc import Iterable, Sequence

from sheath_manip.dataset.marks import learnable
from sheath_manip.dataset.naming import episode_name
from sheath_manip.dataset.reader import EpisodeReader
from sheath_manip.exceptions import ParameterError
from sheath_manip.metrics import ENDED
from sheath_manip.types import Episode, Outcome, Purpose

BY_THE_EXPERT = (Purpose.DEMONSTRATION, Purpose.CALIBRATION)
"""purposes of the episodes that the expert itself drives"""

FAILED = (Outcome.FAILURE, Outcome.TIME_LIMIT)
"""outcomes of episodes that came to an end without success"""


def is_learned_from(purpose: Purpose, outcome: Outcome, failures: bool = False) -> bool:
    """Return whether the labels of an episode are learned from.

    Where the expert itself drove, the episode must have succeeded, unless `failures` are asked for.
    In a round of learning the policy drove, and what the expert says there is worth learning
    however it ended. What came to no end at all, such as by an error, is never learned from, nor
    are the scenes that policies are judged on.
    """
    if purpose is Purpose.EVALUATION:
        return False
    if outcome is Outcome.SUCCESS:
        return True
    return outcome in FAILED and (failures or purpose not in BY_THE_EXPERT)


def learned_from(
    episodes: Sequence[Episode], reader: EpisodeReader, failures: bool, least: int
) -> tuple[list[Episode], list[Outcome]]:
    """Return those of `episodes` that are learned from, and how the others ended.

    What a person marked in `reader`, their store, counts in place of what was recorded, and a
    stretch that is marked bad has no labels. Raises
    ParameterError where fewer than `least` are left.
    """
    taken, left_out = list[Episode](), list[Outcome]()
    for episode in episodes:
        marks = reader.marks(episode_name(episode.info))
        outcome = marks.outcome or episode.outcome
        if is_learned_from(episode.info.purpose, outcome, failures):
            taken.append(learnable(episode, marks))
        else:
            left_out.append(outcome)
    if len(taken) < least:
        raise ParameterError(
            f"{reader.address} holds {len(taken)} of at least {least} expert episodes that are "
            f"wanted to begin with; {left_out_line(left_out)}"
        )
    return taken, left_out


def as_marked(episodes: Iterable[Episode], reader: EpisodeReader) -> list[Episode]:
    """Return episodes of `reader` without labels where a person has marked them as bad."""
    return [learnable(each, reader.marks(episode_name(each.info))) for each in episodes]


def left_out_line(outcomes: Iterable[Outcome]) -> str:
    """Return what is told of episodes of these outcomes that were not learned from."""
    counts = Counter(outcomes)
    failed = _listed({name: count for name, count in counts.items() if name in FAILED})
    others = _listed({name: count for name, count in counts.items() if name not in FAILED})
    listed = "; ".join(filter(None, (failed and f"{failed} (--failures takes them)", others)))
    return f"{counts.total()} episodes left out, which are no demonstrations: {listed}"


def _listed(counts: dict[Outcome, int]) -> str:
    return ", ".join(f"{count} {ENDED[outcome]}" for outcome, count in sorted(counts.items()))
