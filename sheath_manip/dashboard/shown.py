"""Makes the moment that a page shows from an episode and a step in it."""

from collections.abc import Mapping, Sequence

from sheath_manip.dashboard.moment import Moment
from sheath_manip.dashboard.tally import Share
from sheath_manip.learning.results import RoundResult
from sheath_manip.playback.film import Film
from sheath_manip.types import Outcome
from sheath_manip.types.samples import Samples


def moment_of(
    film: Film,
    at: int,
    *,
    series: Share,
    outcomes: Mapping[Outcome, int],
    training: Samples | None,
    paused: bool,
    present: bool,
    results: Sequence[RoundResult] = (),
) -> Moment:
    """The step `at` of `film`, -1 before the first; the rest as in `Moment`.

    `series` are the episodes that have ended; of one that still runs what is seen is added.
    """
    outcome, trace = film.outcome, film.trace.so_far()
    if outcome is None:
        series += Share.of(trace.until(at + 1))
    return Moment(
        info=film.info,
        scene=film.scene,
        pose=film.first_pose if at < 0 else film.poses[at],
        trace=trace,
        steps=film.steps,
        at=at,
        step=None if at < 0 else film.steps[at],
        outcome=outcome if at + 1 == len(trace) else None,
        series=series,
        outcomes=outcomes,
        training=training,
        results=results,
        paused=paused,
        present=present,
    )
