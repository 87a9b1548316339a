"""What every stand-in for a task's expert must do."""

from collections.abc import Iterator

import numpy as np
import pytest

from sheath_manip.exceptions import UnknownNameError
from sheath_manip.protocols import Environment, Expert, Follows
from sheath_manip.tasks.table import TASKS
from sheath_manip.types import Observation, Outcome

SEED = 77
MEMBERS = [(task, name) for task in sorted(TASKS) for name in sorted(TASKS[task].fallbacks)]


@pytest.fixture(params=MEMBERS, ids="-".join, scope="module")
def member(request) -> tuple[str, str]:
    return request.param


@pytest.fixture(scope="module")
def environment(member) -> Iterator[Environment]:
    environment = TASKS[member[0]].make()
    yield environment
    environment.close()


@pytest.fixture(scope="module")
def stand_in(member, environment) -> Expert:
    return TASKS[member[0]].make_expert(environment, member[1])


def follow(stand_in: Expert, observation: Observation) -> None:
    if isinstance(stand_in, Follows):
        stand_in.follow(observation)


def test_acting_alone_it_does_no_harm(environment, stand_in):
    observation = environment.reset(SEED)
    stand_in.reset()
    for _ in range(40):
        follow(stand_in, observation)
        action = environment.spec.action.validated(stand_in.act(observation))
        assert action.dtype == np.float32
        observation = environment.step(action).observation
    assert environment.outcome() is Outcome.TIME_LIMIT


def test_looking_changes_nothing(environment, stand_in):
    observation = environment.reset(SEED)
    stand_in.reset()
    follow(stand_in, observation)
    before = environment.state()
    first = stand_in.act(observation)
    np.testing.assert_array_equal(environment.state(), before)
    np.testing.assert_array_equal(stand_in.act(observation), first)


@pytest.mark.parametrize("task", sorted(TASKS))
def test_an_unknown_expert_is_refused_by_name(task):
    with pytest.raises(UnknownNameError, match="scripted"):
        TASKS[task].make_expert(None, "nobody")  # pyright: ignore[reportArgumentType]
