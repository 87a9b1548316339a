import numpy as np
import pytest

from sheath_manip.exceptions import ParameterError
from sheath_manip.tasks.platformer.enemies import MOST_ENEMIES, PACE_M_S, Enemy
from sheath_manip.tasks.platformer.stage import (
    LEAD_TILES,
    LENGTH_TILES,
    TRAIL_TILES,
    Stage,
    draw_stage,
)
from sheath_manip.tasks.platformer.world import MOST_BLOCKS

SEEDS = range(60)


def stage(seed: int, difficulty: int = 1) -> Stage:
    return draw_stage(np.random.default_rng(seed), difficulty)


def gaps(drawn: Stage) -> list[float]:
    pairs = zip(drawn.blocks, drawn.blocks[1:], strict=False)
    return [after.left - before.right for before, after in pairs if after.left > before.right]


def test_the_seed_makes_the_stage():
    first, again, other = stage(4), stage(4), stage(5)
    np.testing.assert_array_equal(first.heights, again.heights)
    assert (first.blocks, first.enemies) == (again.blocks, again.enemies)
    assert not np.array_equal(first.heights, other.heights)


@pytest.mark.parametrize("difficulty", range(5))
def test_every_stage_fits_its_bounds(difficulty):
    for seed in SEEDS:
        drawn = stage(seed, difficulty)
        assert len(drawn.heights) == LEAD_TILES + LENGTH_TILES + TRAIL_TILES
        assert len(drawn.blocks) <= MOST_BLOCKS
        assert len(drawn.enemies) <= MOST_ENEMIES
        # Safe ground at start and finish.
        assert (drawn.heights[LEAD_TILES : LEAD_TILES + 8] == 3).all()
        assert (drawn.heights[LEAD_TILES + LENGTH_TILES - 8 :] == 3).all()
        # What a run's jump of 8.2 m and 4.2 m height surely crosses and climbs.
        assert max(gaps(drawn)) <= min(3 + difficulty, 6)
        for before, after in zip(drawn.blocks[1:], drawn.blocks[2:], strict=False):
            assert after.height - before.height <= 3


def test_the_blocks_are_the_heights():
    drawn = stage(1)
    heights = np.zeros_like(drawn.heights)
    for block in drawn.blocks:
        assert block.height > 0
        heights[int(block.left) + LEAD_TILES : int(block.right) + LEAD_TILES] = block.height
    np.testing.assert_array_equal(heights, drawn.heights)
    # Two blocks of one height side by side would have a seam to stumble over.
    for before, after in zip(drawn.blocks, drawn.blocks[1:], strict=False):
        assert after.left > before.right or after.height != before.height


def test_harder_stages_are_denser():
    counts = np.array(
        [
            np.mean([(len(gaps(drawn)), len(drawn.enemies)) for drawn in drawns], axis=0)
            for drawns in ([stage(seed, difficulty) for seed in SEEDS] for difficulty in range(4))
        ]
    )
    assert (np.diff(counts, axis=0) > 0).all()
    # Of difficulty 1: what the learning experiments are about.
    assert counts[1, 0] > 5
    assert 5 < counts[1, 1] < 12
    assert sum(block.pipe for seed in SEEDS for block in stage(seed).blocks) > 2 * len(SEEDS)


def test_enemies_stay_on_their_ground():
    for enemy in (enemy for seed in SEEDS for enemy in stage(seed, 2).enemies):
        for step in range(0, 800, 7):
            x, z = enemy.position(step)
            assert enemy.left_m <= x <= enemy.right_m
            assert z >= enemy.ground_m + 0.4
        drawn_columns = int(enemy.left_m), int(enemy.right_m)
        assert drawn_columns[0] >= 8


def test_a_walker_paces_to_and_fro():
    enemy = Enemy(10.0, 14.0, 3.0, hops=False, phase=0.0)
    x = np.array([enemy.position(step)[0] for step in range(97)])
    assert (x[0], x[48], x[96]) == pytest.approx((10.0, 14.0, 10.0))
    np.testing.assert_allclose(np.abs(np.diff(x)), PACE_M_S / 24)


def test_a_hopper_leaves_the_ground_and_comes_back():
    enemy = Enemy(10.0, 14.0, 3.0, hops=True, phase=0.0)
    z = np.array([enemy.position(step)[1] for step in range(64)])
    assert z.max() == pytest.approx(3.4 + 2.2)
    assert (z[20:32] == 3.4).all()


def test_a_negative_difficulty_is_refused():
    with pytest.raises(ParameterError, match="wanted 0 or more"):
        stage(0, -1)
