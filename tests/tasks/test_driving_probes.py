import numpy as np
import pytest

from sheath_manip.tasks.driving.entry import DRIVING
from sheath_manip.tasks.driving.study.probes import COSTLY_REGRET, FRONT_GAP_M, PROBES


@pytest.fixture(scope="module")
def road():
    environment = DRIVING.make()
    yield environment
    environment.close()


def coordinates(environment):
    task = environment.task
    x, y, heading = task.pose(environment.physics)
    along, lateral, direction = task.track.coordinates(x, y)
    return along, lateral, np.rad2deg(np.angle(np.exp(1j * (heading - direction))))


@pytest.mark.parametrize("displacement", PROBES.displacements, ids=lambda d: d.name)
def test_a_displacement_is_where_its_name_says_and_is_undone_by_restoring(road, displacement):
    before = road.reset(3)
    state, (along, lateral, turned) = road.state(), coordinates(road)
    seen = displacement.apply(road, np.random.default_rng(0))
    assert not np.array_equal(seen.images["overhead"], before.images["overhead"])
    now = coordinates(road)
    assert now[0] == pytest.approx(along, abs=1e-6)
    kind, value, *_ = displacement.name.split()
    if kind == "lateral":
        assert abs(now[1]) == pytest.approx(float(value), abs=1e-6)
    elif kind == "heading":
        assert abs(now[2]) == pytest.approx(float(value.rstrip("°")), abs=1e-6)
    else:
        assert np.allclose(now[1:], (lateral, turned))
        here = road.task.pose(road.physics)[:2]
        others = road.task.traffic_poses(np.asarray(road.physics.time()))[:, :2]
        assert np.linalg.norm(others - here, axis=1).min() == pytest.approx(FRONT_GAP_M, abs=0.3)
    after = road.restore(state)
    np.testing.assert_array_equal(after.images["overhead"], before.images["overhead"])


def test_the_experts_own_action_has_no_regret_and_a_crash_is_costly(road):
    expert = DRIVING.expert(road)
    observation = road.reset(4)
    action = expert.act(observation)
    assert PROBES.regret(expert, action) == 0
    choices = road.spec.action.choices
    # A car right in front: ahead is a crash, aside may not be.
    PROBES.displacements[-1].apply(road, np.random.default_rng(0))
    assert max(PROBES.regret(expert, choice) for choice in choices) > COSTLY_REGRET
