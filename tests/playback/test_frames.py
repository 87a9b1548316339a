"""The frames of films: as wide as a README shows them, to the last observation, readable by all."""

from dataclasses import replace

import numpy as np
import pytest

from sheath_manip.playback import palette
from sheath_manip.playback.film import Film, film_of
from sheath_manip.playback.frames import WIDTH_PX, frames, round_times, seen
from sheath_manip.playback.trace import trace_of
from sheath_manip.types import Actor, Episode, EpisodeInfo, Outcome, Purpose
from tests.dashboard.conftest import RingRoad, drive
from tests.episodes import episode_of

STEPS = 12
INFO = EpisodeInfo("toy", 1, Purpose.LEARNING, 10.0, "sheath", 1)


def flat(level: int) -> np.ndarray:
    return np.full((40, 80, 3), level, np.uint8)


@pytest.fixture(scope="module")
def episode() -> Episode:
    return episode_of("pppeeepppppp", info=INFO, outcome=Outcome.FAILURE, side_px=40)


def test_a_film_has_a_frame_more_than_steps_and_the_last_is_the_last_observation() -> None:
    film = film_of(RingRoad(), replace(drive(RingRoad(), STEPS), outcome=Outcome.SUCCESS))
    drawn = list(frames(film.trace.so_far(), film.outcome, seen(film)))
    assert len(drawn) == STEPS + 1
    assert {frame.shape for frame in drawn} == {drawn[0].shape}
    assert drawn[0].shape[1] == WIDTH_PX >= 720
    assert drawn[0].shape[0] % 2 == 0
    last = drive(RingRoad(), STEPS).final_observation
    assert film.observation(STEPS).time_s == last.time_s > film.observation(STEPS - 1).time_s
    green = (drawn[-1] == palette.OUTCOME[Outcome.SUCCESS]).all(-1)
    assert green.sum() > 10_000
    assert not (drawn[-2] == palette.OUTCOME[Outcome.SUCCESS]).all(-1).any()


def test_a_film_of_an_episode_that_still_runs_ends_with_its_last_step(episode) -> None:
    trace = trace_of(episode)
    assert len(list(frames(trace, None, flat))) == STEPS
    assert len(list(frames(trace, Outcome.FAILURE, flat, slice(2, 6)))) == 4
    assert len(list(frames(trace, Outcome.FAILURE, flat, slice(6, STEPS)))) == 7
    film = Film(INFO, (), RingRoad().pose())
    with pytest.raises(IndexError, match="still runs"):
        film.observation(0)


def test_each_frame_shows_its_own_moment_and_who_acts(episode) -> None:
    shown = list(frames(trace_of(episode), episode.outcome, flat, moments=(0, 4, STEPS)))
    assert [int(frame[100, 300, 0]) for frame in shown] == [0, 4, STEPS]
    colours = [tuple(int(value) for value in frame[364, 500]) for frame in shown]
    assert colours[0] == palette.ACTOR[Actor.POLICY]
    assert colours[1] != colours[0]
    assert colours[2] == palette.OUTCOME[Outcome.FAILURE]


def test_who_acts_is_told_without_colours(episode) -> None:
    (frame,) = frames(trace_of(episode), None, flat, moments=(11,))
    strip = frame[360 + 36 : 360 + 36 + 20]
    inked = np.any(strip < 250, axis=-1)
    by_policy, by_expert = (int(np.sum(inked[:, column])) for column in (100, 300))
    assert by_policy < 0.7 * by_expert


@pytest.mark.parametrize(
    ("first_s", "last_s", "wanted"),
    [
        (4.2, 7.2, [4.5, 5.0, 5.5, 6.0, 6.5, 7.0]),
        (0.0, 15.0, [0, 2, 4, 6, 8, 10, 12, 14]),
        (0.0, 0.5, [0.0, 0.1, 0.2, 0.3, 0.4, 0.5]),
    ],
)
def test_times_are_round(first_s, last_s, wanted) -> None:
    assert round_times(first_s, last_s) == pytest.approx(wanted)


def test_letters_stand_out_from_their_bar() -> None:
    assert palette.readable_on(palette.ACTOR[Actor.HOLD]) == palette.BLACK
    assert palette.readable_on(palette.ACTOR[Actor.POLICY]) == palette.WHITE
    assert palette.readable_on((255, 255, 255)) == palette.BLACK


def test_methods_and_actors_never_share_a_look() -> None:
    looks = palette.methods(("cloning", "dagger", "sheath", "random-takeover"))
    assert not {look.rgb for look in looks.values()} & set(palette.ACTOR.values())
    assert len({look.marker for look in looks.values()}) == 4
    assert len({look.dashes for look in looks.values()}) == 4
    # In grey they are still told apart.
    grey = sorted(float(np.dot(look.rgb, (0.2126, 0.7152, 0.0722))) for look in looks.values())
    assert min(np.diff(grey)) > 15
