"""The platformer's episodes: how the player moves, what ends one, what repeats it to the bit."""

import numpy as np
import pytest

from sheath_manip.tasks.platformer.enemies import Enemy
from sheath_manip.tasks.platformer.game import RADIUS_M
from sheath_manip.tasks.platformer.stage import LENGTH_TILES
from sheath_manip.tasks.platformer.task import Scenario
from sheath_manip.types import Outcome
from tests.tasks.platformer_play import (
    FLAT,
    JUMP,
    LEFT,
    REST,
    RIGHT,
    RUN,
    RUN_AND_JUMP,
    Play,
    buttons_at_random,
    laid,
    play,
)

__all__ = ["play"]


def test_moved_blocks_carry_the_player(play):
    for seed in range(20):
        play.environment.reset(seed)
        before = play.task.moment
        play.press(*[REST] * 5)
        assert play.task.moment.z == pytest.approx(3 + RADIUS_M, abs=0.01)
        assert play.task.moment.x == pytest.approx(before.x, abs=1e-6)
        assert play.task.moment.grounded


def test_no_two_stages_share_a_block_that_was_not_moved(play):
    play.on(laid((-14, 10, 3), (10, 12, 6), (12, 234, 3)), 8.0)
    play.press(*[RUN] * 24)
    assert play.task.moment.x == pytest.approx(10 - RADIUS_M, abs=0.02)
    play.on(FLAT, 8.0)
    play.press(*[RUN] * 24)
    assert play.task.moment.x > 16


@pytest.mark.parametrize(("buttons", "speed"), [(RIGHT, 6.0), (RUN, 10.0), (LEFT, -6.0)])
def test_walks_and_runs(play, buttons, speed):
    play.on(FLAT, 20.0)
    play.press(*[buttons] * 24)
    assert play.task.moment.vx == pytest.approx(speed, abs=0.01)
    play.press(*[REST] * 12)
    assert play.task.moment.vx == pytest.approx(0.0, abs=0.1)


def test_the_longer_the_button_the_higher_the_jump(play):
    tops = []
    for held in (1, 4, 12):
        play.on(FLAT)
        z = play.heights([*[JUMP] * held, *[REST] * (24 - held)])
        assert z[-1] == pytest.approx(3 + RADIUS_M, abs=0.01)
        tops.append(z.max() - z[-1])
    assert 1.0 < tops[0] < tops[1] - 0.5 < tops[2] - 1.0
    assert tops[2] == pytest.approx(4.1, abs=0.15)


def test_a_held_button_jumps_once(play):
    play.on(FLAT)
    z = play.heights([JUMP] * 40)
    assert np.ptp(z[24:]) < 0.01
    assert play.named("may_jump") == {"may_jump": 0.0}
    play.press(REST)
    assert play.named("may_jump") == {"may_jump": 1.0}
    assert play.heights([JUMP] * 4).max() > 4.5


def test_a_wall_is_no_ground(play):
    play.on(laid((-14, 10, 3), (10, 234, 12)), 8.0)
    play.press(*[RUN] * 12, *[RUN_AND_JUMP] * 6, *[RUN] * 2)
    assert not play.task.moment.grounded
    top = play.heights([RUN_AND_JUMP] * 12).max()
    assert top < 8.0


def test_a_fall_is_a_failure(play):
    play.on(laid((-14, 6, 3), (12, 234, 3)))
    transitions = play.press(*[RUN] * 60)
    assert transitions[-1].terminated
    assert transitions[-1].reward == -1.0
    assert play.environment.outcome() is Outcome.FAILURE
    assert 6 < play.environment.metrics()["distance_tiles"] < 12


def test_a_jump_crosses_the_gap(play):
    play.on(laid((-14, 8, 3), (14, 234, 3)))
    play.press(*[RUN] * 16, *[RUN_AND_JUMP] * 12, *[RUN] * 12)
    assert play.environment.outcome() is Outcome.TIME_LIMIT
    assert play.task.moment.x > 14
    assert play.task.moment.grounded


@pytest.mark.parametrize("hops", [False, True])
def test_an_enemy_kills_from_the_side(play, hops):
    play.on(laid((-14, 234, 3), enemies=(Enemy(6.0, 9.0, 3.0, hops, 0.9),)))
    transitions = play.press(*[RIGHT] * 100)
    assert transitions[-1].terminated
    assert play.environment.outcome() is Outcome.FAILURE
    assert play.environment.metrics()["stomped"] == 0.0


def test_an_enemy_is_stomped_from_above(play):
    play.on(laid((-14, 234, 3), enemies=(Enemy(4.0, 4.5, 3.0, False, 0.0),)), 4.2)
    play.task.put(play.environment.physics, play.task.moment._replace(z=6.0, grounded=False))
    play.press(*[REST] * 4)
    rising = play.heights([REST] * 8)
    assert play.environment.metrics()["stomped"] == 1.0
    assert play.environment.outcome() is Outcome.TIME_LIMIT
    assert rising.max() > 4.2
    # Nobody is there any more.
    play.press(*[REST] * 40)
    assert play.environment.outcome() is Outcome.TIME_LIMIT
    assert not any(play.named("enemy").values())


def test_the_flag_is_a_success(play):
    play.on(FLAT, 210.0)
    transitions = play.press(*[RUN] * 60)
    assert transitions[-1].terminated
    assert play.environment.outcome() is Outcome.SUCCESS
    metrics = play.environment.metrics()
    assert metrics["distance_tiles"] == LENGTH_TILES
    assert metrics["progress"] == 1.0


def test_the_time_limit_is_a_truncation(play):
    play.on(FLAT)
    transitions = play.press(*[REST] * 1000)
    assert len(transitions) == 35 * 24
    assert (transitions[-1].terminated, transitions[-1].truncated) == (False, True)
    assert play.environment.outcome() is Outcome.TIME_LIMIT


@pytest.mark.parametrize("start", [0, 1, 9])
def test_restored_it_continues_to_the_bit(play, start):
    environment, buttons = play.environment, buttons_at_random(20)
    environment.reset(11)
    states, seen = [environment.state()], []
    for each in buttons:
        seen += [transition.observation for transition in play.press(each)]
        states.append(environment.state())
    environment.reset(11)
    restored = environment.restore(states[start])
    np.testing.assert_array_equal(environment.state(), states[start])
    if start:
        np.testing.assert_array_equal(restored.features, seen[start - 1].features)
    for each, wanted, state in zip(
        buttons[start:], seen[start:], states[start + 1 :], strict=False
    ):
        (transition,) = play.press(each)
        np.testing.assert_array_equal(transition.observation.features, wanted.features)
        np.testing.assert_array_equal(environment.state(), state)


def test_the_same_seed_and_buttons_give_the_same_episode_to_the_bit(play):
    buttons, states = buttons_at_random(30), []
    other = Play(Scenario())
    for each in (play, other):
        each.environment.reset(5)
        each.press(*buttons)
        states.append(each.environment.state())
    np.testing.assert_array_equal(*states)
    other.environment.close()


def test_fresh_stages_by_seed(play):
    play.environment.reset(1)
    first = play.task.stage
    play.environment.reset(2)
    assert not np.array_equal(first.heights, play.task.stage.heights)


def test_one_stage_with_other_starts():
    play = Play(Scenario(stage=3))
    play.environment.reset(1)
    first, start = play.task.stage, play.task.moment
    play.environment.reset(2)
    np.testing.assert_array_equal(first.heights, play.task.stage.heights)
    assert first.blocks == play.task.stage.blocks
    assert first.enemies == play.task.stage.enemies
    assert start.x != play.task.moment.x
    play.environment.close()
