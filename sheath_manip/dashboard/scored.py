"""What is known of an episode's scores, for previews of another threshold."""

from sheath_manip.gates.what_if import ScoredEpisode
from sheath_manip.playback.film import Film
from sheath_manip.types import Outcome

MOST_SCORED = 200
"""episodes, the latest: previews of more take too long for a slider"""


def scored(film: Film) -> ScoredEpisode:
    """Return the scores of an episode, also of one that still runs."""
    trace, outcome = film.trace.so_far(), film.outcome
    return ScoredEpisode(trace.score, outcome is Outcome.FAILURE, ended=outcome is not None)
