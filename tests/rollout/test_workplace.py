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
from sheath_manip.types import EpisodeInfo, Purpose
from tests.toy import CORRIDOR, Corridor

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


@pytest.mark.parametrize("name", TASKS)
def test_copies_of_a_task_make_the_same(name: str):
    task = TASKS[name]
    sent = pickle.dumps(task)
    one, other = pickle.loads(sent), pickle.loads(sent)
    # By way of another process that has the workers.
    farther = pickle.loads(pickle.dumps(other))
    variants = [*task.variants, *task.run_variants]
    assert all(one.makes_as(other, variant) for variant in variants)
    assert all(one.makes_as(farther, variant) for variant in variants)
    assert not one.makes_as(replace(other, name="another"), variants[0])
