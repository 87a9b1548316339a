"""All that one drawing of the page shows."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from sheath_manip.burden import StepCounts
from sheath_manip.dashboard.tally import counts_of_trace
from sheath_manip.gates.what_if import ScoredEpisode
from sheath_manip.learning.results import RoundResult
from sheath_manip.playback.film import Film
from sheath_manip.playback.trace import Trace
from sheath_manip.types import EpisodeInfo, Outcome, SceneGeom, ScenePose, Step
from sheath_manip.types.samples import Samples
from sheath_manip.types.work import Headway


@dataclass(frozen=True, eq=False)
class Snapshot:
    """One step of an episode, the present one or one that is looked back at."""

    info: EpisodeInfo
    scene: tuple[SceneGeom, ...]
    """the same object throughout an episode"""
    pose: ScenePose
    """after the step"""
    trace: Trace
    """of the whole episode, as far as it is known"""
    steps: Sequence[Step]
    """of the same; it may have grown meanwhile"""
    at: int
    """the step, from 0; -1 before the first"""
    step: Step | None
    """the one at `at`"""
    outcome: Outcome | None
    """of the episode, where it has ended with this step"""
    episode: StepCounts
    """of this episode as far as `at`"""
    series: StepCounts
    """of all episodes of the same method and purpose, this one as far as `at` included"""
    outcomes: Mapping[Outcome, int]
    """of those that have ended"""
    training: Samples | None
    """what the policy was fitted to; the same object until it is fitted anew"""
    results: Sequence[RoundResult] = ()
    """of the rounds of learning so far; the same object until there is one more"""
    headway: Headway | None = None
    """of the whole run, where it says how far it is"""
    work: str = ""
    """that is done while no episode runs"""
    scored: Sequence[ScoredEpisode] = ()
    """episodes with scores that are shown, but for one that runs; the same object until there are
    more"""
    paused: bool = False
    """whether a person holds the run"""
    present: bool = True
    """whether this is the latest step there is"""


def snapshot_of(
    film: Film,
    at: int,
    *,
    series: StepCounts,
    outcomes: Mapping[Outcome, int],
    training: Samples | None,
    paused: bool,
    present: bool,
    results: Sequence[RoundResult] = (),
    headway: Headway | None = None,
    work: str = "",
    scored: Sequence[ScoredEpisode] = (),
) -> Snapshot:
    """Return the step `at` of `film`, -1 before the first; the rest as in `Snapshot`.

    `series` are the episodes that have ended; of one that still runs what is seen is added.
    """
    outcome, trace = film.outcome, film.trace.so_far()
    episode = counts_of_trace(trace.until(at + 1), film.info.control_rate_hz)
    return Snapshot(
        info=film.info,
        scene=film.scene,
        pose=film.first_pose if at < 0 else film.poses[at],
        trace=trace,
        steps=film.steps,
        at=at,
        step=None if at < 0 else film.steps[at],
        outcome=outcome if at + 1 == len(trace) else None,
        episode=episode,
        series=series if outcome is not None else series + episode,
        outcomes=outcomes,
        training=training,
        results=results,
        headway=headway,
        work=work,
        scored=scored,
        paused=paused,
        present=present,
    )
