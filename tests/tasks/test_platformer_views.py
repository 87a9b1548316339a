"""What is seen of the platformer: its features, its pictures, and what a viewer shows."""

import numpy as np
import pytest

from sheath_manip.tasks.platformer.enemies import Enemy
from sheath_manip.tasks.platformer.features import COLUMNS, ROWS
from sheath_manip.tasks.platformer.game import RUN_M_S
from sheath_manip.tasks.platformer.picture import frame, whole_stage
from sheath_manip.tasks.platformer.task import Scenario
from tests.tasks.platformer_play import FLAT, RUN, RUN_AND_JUMP, Play, buttons_at_random, laid, play

__all__ = ["play"]


def test_the_features_are_named_and_binary(play):
    names = play.environment.spec.feature_names
    assert 400 <= len(names) <= 700
    play.environment.reset(0)
    for transition in play.press(*buttons_at_random(30)):
        assert set(np.unique(transition.observation.features)) <= {0.0, 1.0}
        assert transition.observation.features.shape == (len(names),)


def test_the_grid_shows_ground_and_enemies(play):
    play.on(laid((-14, 5, 3), (8, 234, 4), enemies=(Enemy(8.5, 8.9, 4.0, False, 0.0),)), 3.5)
    for column in COLUMNS:
        ground = 0 if 2 <= column < 5 else 3 if column < 2 else 4
        for row in ROWS:
            name = f"solid_0_steps_ago_{column:+d}_{row:+d}_tiles"
            # The player stands in row 3, whose column is 3.
            assert play.named(name)[name] == float(3 + row < ground), name
    enemies = {name for name, value in play.named("enemy").items() if value}
    assert enemies == {f"enemy_{lag}_steps_ago_+5_+1_tiles" for lag in (0, 3, 6)}


def test_earlier_grids_lag_behind(play):
    play.on(laid((-14, 12, 3), (15, 234, 3)))
    shown = []
    for _ in range(9):
        play.press(RUN)
        shown.append([list(play.named(f"solid_{lag}_steps").values()) for lag in (0, 3, 6)])
    for step in range(6, 9):
        assert shown[step][1] == shown[step - 3][0]
        assert shown[step][2] == shown[step - 6][0]


def test_the_own_state_is_told(play):
    play.on(FLAT)
    play.press(*[RUN] * 24)
    assert play.named("on_ground") == {"on_ground": 1.0}
    assert sum(play.named("vx_bucket").values()) == sum(play.named("vz_bucket").values()) == 1.0
    assert play.named("vx_bucket")["vx_bucket_8"] == 1.0
    assert play.named("z_within")["z_within_tile_0"] == 1.0
    assert play.task.moment.vx == pytest.approx(RUN_M_S, abs=0.01)
    play.press(RUN_AND_JUMP)
    assert play.named("on_ground") == {"on_ground": 0.0}
    assert play.named("jump") == {"jump_held": 1.0, **{
        f"jump_{ago}_steps_ago": float(ago == 1) for ago in (1, 2, 3)
    }}  # fmt: skip


def test_the_pixels_follow_the_player():
    play = Play(Scenario(image_px=84))
    first = play.environment.reset(3).images["side"]
    assert first.shape == (84, 84, 3)
    later = play.press(*[RUN] * 12)[-1].observation.images["side"]
    assert not np.array_equal(first, later)
    # The red ball stays where it was in the picture.
    for image in (first, later):
        red = (image[..., 0] > 120) & (image[..., 1:] < 60).all(axis=2)
        assert np.argwhere(red).mean(axis=0) == pytest.approx((46, 23), abs=3)
    play.environment.close()


def test_pictures_for_figures():
    play = Play(Scenario())
    play.environment.reset(3)
    assert frame(play.environment, 320, 200).shape == (200, 320, 3)
    strips = whole_stage(play.environment, 400, strips=2)
    assert strips.shape[1:] == (400, 3)
    assert strips.std() > 10
    play.environment.close()


def test_viewers_see_the_stage_as_it_is_laid(play):
    play.on(laid((-14, 5, 3), (8, 10, 5), (10, 234, 3)))
    boxes = {
        (round(geom.position_in_body[0], 3), round(geom.size[2], 3))
        for geom in play.environment.scene()
        if geom.shape == "box" and geom.body == 0
    }
    assert {(-4.5, 1.5), (9.0, 2.5), (122.0, 1.5)} <= boxes
    play.press(*[RUN] * 5)
    shown = play.environment.pose().bodies[:, [0, 2]]
    moment = play.task.moment
    assert np.abs(shown - [moment.x, moment.z]).sum(axis=1).min() < 1e-9
