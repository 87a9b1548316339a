"""What the gates of gauze cutting are tested with."""

import numpy as np
import pytest

from sheath_manip.tasks.gauze_cutting.entry import GAUZE_CUTTING
from sheath_manip.tasks.gauze_cutting.study.probes import COSTLY_MM, PROBES


@pytest.fixture(scope="module")
def bench():
    environment = GAUZE_CUTTING.make("calm")
    yield environment
    environment.close()


def driven(bench, seed: int, steps: int):
    """The expert after so many steps."""
    expert = GAUZE_CUTTING.expert(bench)
    observation = bench.reset(seed)
    expert.reset()
    for _ in range(steps):
        observation = bench.step(expert.act(observation)).observation
    return expert, observation


@pytest.mark.parametrize("displacement", PROBES.displacements, ids=lambda d: d.name)
def test_a_displacement_is_where_its_name_says_and_is_undone_by_restoring(bench, displacement):
    _, before = driven(bench, 3, steps=6)
    state, tip_m = bench.state(), bench.task.tip_m
    seen = displacement.apply(bench, np.random.default_rng(0))
    assert not np.array_equal(seen.images["overhead"], before.images["overhead"])
    kind, value, _ = displacement.name.split()
    moved_mm = 1e3 * (bench.task.tip_m - tip_m)
    assert np.linalg.norm(moved_mm) == pytest.approx(float(value), abs=0.1)
    assert (abs(moved_mm[2]) > 1) == (kind == "lifted")
    after = bench.restore(state)
    np.testing.assert_array_equal(after.images["overhead"], before.images["overhead"])
    np.testing.assert_array_equal(bench.state(), state)


def test_the_experts_own_action_has_no_regret_and_one_across_the_line_is_costly(bench):
    expert, observation = driven(bench, 4, steps=6)
    action = expert.act(observation)
    assert PROBES.regret(expert, action) < 0.01
    across = np.array([-action[1], action[0]])
    assert PROBES.regret(expert, across) > COSTLY_MM
    assert PROBES.regret(expert, -across) > COSTLY_MM
