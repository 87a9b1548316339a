"""Which episodes of a store are fitted to, and which are held out: told without reading them."""

from collections.abc import Sequence

from sheath_manip.dataset.naming import scene_of
from sheath_manip.dataset.reader import EpisodeSummary
from sheath_manip.exceptions import ParameterError
from sheath_manip.learning.demonstrations import BY_THE_EXPERT, is_learned_from, left_out_line
from sheath_manip.types import Purpose


def learned_and_left(
    summaries: Sequence[EpisodeSummary], failures: bool
) -> tuple[list[EpisodeSummary], list[EpisodeSummary]]:
    """Return the episodes with something to learn from, and those left out for how they ended."""
    taken, left_out = list[EpisodeSummary](), list[EpisodeSummary]()
    for each in summaries:
        if each.info.purpose is Purpose.EVALUATION:
            continue
        if each.queries or each.info.purpose in BY_THE_EXPERT:
            learned = is_learned_from(each.info.purpose, each.outcome, failures)
            (taken if learned else left_out).append(each)
    return taken, left_out


def split_off(
    taken: Sequence[EpisodeSummary],
    left_out: Sequence[EpisodeSummary],
    held_out: int,
    where: str,
    remedy: str,
) -> tuple[list[str], list[str]]:
    """Return the names of the episodes to fit to, and of the expert's last few, held out.

    Of a scene that was recorded more than once all is held out, or nothing. Raises ParameterError
    where there are not more of the expert's than are held out `where` they lie; `remedy` says how
    more are had.
    """
    expert = sorted(
        (each for each in taken if each.info.purpose in BY_THE_EXPERT),
        key=lambda s: (s.info.purpose is Purpose.CALIBRATION, s.info.round, s.info.index, s.name),
    )
    last = expert[max(len(expert) - held_out, 0) :]
    scenes = {scene_of(each.info) for each in last}
    names = [each.name for each in expert if scene_of(each.info) in scenes]
    if len(expert) <= len(names):
        told = f" ({left_out_line(s.outcome for s in left_out)})" if left_out else ""
        raise ParameterError(
            f"{where} holds {len(expert)} expert episodes to learn from{told}; wanted "
            f"more than the {held_out} that are held out: {remedy}, or give a smaller "
            "--calibration"
        )
    return [s.name for s in taken if s.name not in set(names)], names
