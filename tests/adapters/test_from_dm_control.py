import sys

import numpy as np
import pytest

from sheath_manip.adapters.from_dm_control import from_dm_control
from sheath_manip.adapters.from_robosuite import from_robosuite
from sheath_manip.exceptions import ParameterError, SetupError
from sheath_manip.protocols import Restorable, Viewable
from sheath_manip.testing import check_task


class ToTarget:
    def __init__(self, environment) -> None:
        self.physics = environment.physics

    def act(self, seen):
        return np.clip(2 * seen["to_target"], -1, 1)


def bricks():
    from dm_control import manipulation

    return manipulation.load("reach_site_features", seed=0)


def test_a_task_of_the_suite_keeps_the_contract() -> None:
    task = from_dm_control("reacher/easy", expert=ToTarget, max_steps=20)
    check_task(task)
    assert task.name == "reacher-easy"


def test_a_task_of_the_suite_goes_on_from_a_state_to_the_bit() -> None:
    environment = from_dm_control("cartpole/swingup").make()
    spec = environment.spec
    assert (spec.control_rate_hz, spec.max_steps) == (100, 1000)
    assert isinstance(environment, Restorable)
    assert isinstance(environment, Viewable)
    actions = np.random.default_rng(0).uniform(-1, 1, (8, 1)).astype(np.float32)
    environment.reset(4)
    environment.step(actions[0])
    state, bodies = environment.state(), environment.pose().bodies

    def gone_on() -> list:
        return [environment.step(action).observation.features for action in actions]

    first = gone_on()
    environment.reset(4)
    np.testing.assert_array_equal(environment.pose_at(state).bodies, bodies)
    np.testing.assert_array_equal(gone_on(), first)
    environment.close()


def test_composers_environment_ends_at_its_time_limit_and_is_seeded() -> None:
    task = from_dm_control(bricks, name="reach-site")
    environment = task.make()
    assert environment.spec.max_steps == 250
    first, other, again = (environment.reset(seed).features for seed in (1, 2, 1))
    np.testing.assert_array_equal(first, again)
    assert (first != other).any()
    environment.close()


def test_what_cannot_be_made_is_said_in_a_line(monkeypatch) -> None:
    with pytest.raises(ParameterError, match="suite has no 'cartpole/fly'"):
        from_dm_control("cartpole/fly").make()
    with pytest.raises(ParameterError, match="wants a name="):
        from_dm_control(bricks)
    monkeypatch.setitem(sys.modules, "robosuite", None)
    with pytest.raises(SetupError, match="install it with `pip install robosuite"):
        from_robosuite("Lift").make()
