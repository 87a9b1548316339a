"""The platformer by itself, mostly on stages that are laid by hand."""

from collections.abc import Iterator, Sequence

import numpy as np
import pytest

from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.platformer.enemies import Enemy
from sheath_manip.tasks.platformer.features import COLUMNS, ROWS
from sheath_manip.tasks.platformer.game import RADIUS_M, RUN_M_S, Buttons
from sheath_manip.tasks.platformer.picture import frame, whole_stage
from sheath_manip.tasks.platformer.stage import LEAD_TILES, LENGTH_TILES, TRAIL_TILES, Block, Stage
from sheath_manip.tasks.platformer.task import CHOICES, PlatformerTask, Scenario
from sheath_manip.types import Outcome, Transition

REST = Buttons(False, False, False, False)
LEFT, RIGHT = REST._replace(left=True), REST._replace(right=True)
RUN, JUMP = RIGHT._replace(speed=True), REST._replace(jump=True)
RUN_AND_JUMP = RUN._replace(jump=True)


def pressed(buttons: Buttons) -> np.ndarray:
    return np.array(buttons, np.float32)


def laid(*blocks: tuple[float, float, float], enemies: tuple[Enemy, ...] = ()) -> Stage:
    """A stage of (left, right, height); elsewhere are gaps."""
    heights = np.zeros(LEAD_TILES + LENGTH_TILES + TRAIL_TILES, np.int16)
    for left, right, height in blocks:
        heights[int(left) + LEAD_TILES : int(right) + LEAD_TILES] = height
    return Stage(heights, tuple(Block(*block) for block in blocks), enemies)


FLAT = laid((-14, 234, 3))


class Play:
    """An environment with its task, under names of their own types."""

    def __init__(self, scenario: Scenario) -> None:
        self.task = PlatformerTask(scenario)
        self.environment = ComposerEnvironment(self.task)

    def on(self, stage: Stage, x_m: float = 1.0) -> None:
        self.environment.reset(0)
        self.task.play(self.environment.physics, stage, x_m)

    def press(self, *buttons: Buttons) -> list[Transition]:
        """One step each, up to the end of the episode."""
        transitions = []
        for each in buttons:
            transitions.append(self.environment.step(pressed(each)))
            if transitions[-1].terminated or transitions[-1].truncated:
                break
        return transitions

    def heights(self, buttons: Sequence[Buttons]) -> np.ndarray:
        z = []
        for each in buttons:
            self.press(each)
            z.append(self.task.moment.z)
        return np.array(z)

    def named(self, start: str) -> dict[str, float]:
        seen = self.environment.observe().features.tolist()
        pairs = zip(self.environment.spec.feature_names, seen, strict=True)
        return {name: value for name, value in pairs if name.startswith(start)}


@pytest.fixture(scope="module")
def play() -> Iterator[Play]:
    play = Play(Scenario())
    yield play
    play.environment.close()


def buttons_at_random(count: int) -> list[Buttons]:
    rng = np.random.default_rng(1)
    return [RUN, *(CHOICES[index] for index in rng.integers(len(CHOICES), size=count))]


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
