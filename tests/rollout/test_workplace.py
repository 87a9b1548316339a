"""One environment serves all episodes that want the same, whatever process asks for them."""

import pickle
from dataclasses import replace
from functools import partial

import pytest

from sheath_manip.learning.drivers import ExpertAlone
from sheath_manip.rollout.request import EpisodeRequest
from sheath_manip.rollout.workplace import Workplace
from sheath_manip.task import Task
from sheath_manip.tasks.table import TASKS
from sheath_manip.types import Action, EpisodeInfo, Observation, Purpose
from tests.toy import CHOICES, CORRIDOR, Corridor

made: list[int] = []


def make(steps: int) -> Corridor:
    made.append(steps)
    return Corridor(steps=steps)


def corridor(**variants: int) -> Task:
    return replace(CORRIDOR, variants={name: partial(make, n) for name, n in variants.items()})


def sent(task: Task, seed: int, variant: str = "default") -> EpisodeRequest:
    """The request as a worker gets it: each one a copy."""
    info = EpisodeInfo("corridor", seed, Purpose.EVALUATION, 50.0, variant=variant)
    return pickle.loads(pickle.dumps(EpisodeRequest(task, info, ExpertAlone())))


def test_requests_from_another_process_share_an_environment():
    made.clear()
    task = corridor(default=8, final=12)
    with Workplace() as workplace:
        lengths = [len(workplace.run(sent(task, seed))) for seed in range(3)]
        assert (made, lengths) == ([8], [8, 8, 8])
        assert len(workplace.run(sent(task, 0, "final"))) == 12
        # Of the same name, and made otherwise.
        assert len(workplace.run(sent(corridor(default=9, final=10), 0, "final"))) == 10
    assert made == [8, 12, 10]


class Aside:
    """An expert that always steps to the same side."""

    def __init__(self, choice: int, environment: Corridor) -> None:
        del environment
        self.choice = choice

    def reset(self) -> None:
        pass

    def act(self, observation: Observation) -> Action:
        del observation
        return CHOICES[self.choice]


def test_who_acts_is_another_where_the_task_has_another_expert():
    tasks = [replace(corridor(default=8), expert=partial(Aside, choice)) for choice in (0, 2)]
    with Workplace() as workplace:
        first, second = (workplace.run(sent(task, 0)).steps[0] for task in tasks)
    assert (first.executed == CHOICES[0]).all()
    assert (second.executed == CHOICES[2]).all()


@pytest.mark.parametrize("name", TASKS)
def test_copies_of_a_task_are_the_same(name: str):
    task = TASKS[name]
    bytes = pickle.dumps(task)
    one, other = pickle.loads(bytes), pickle.loads(bytes)
    assert one.same_as(other)
    # By way of another process that has the workers.
    assert one.same_as(pickle.loads(pickle.dumps(other)))
    assert not one.same_as(replace(other, name="another"))
