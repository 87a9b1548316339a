"""What broke down in an episode is kept as runs of steps, and comes back step by step."""

from dataclasses import asdict, replace

import pytest

from sheath_manip.dataset.broken_steps import (
    BrokenSteps,
    broken_by_step,
    broken_from_json,
    broken_steps,
)
from sheath_manip.types import Breakdown, Episode, Outcome
from tests.episodes import episode_of

POLICY, GATE = Breakdown("policy", "ValueError"), Breakdown("gate", "hung")


def with_broken(*rows: tuple[Breakdown, ...], cut_short_by: Breakdown | None = None) -> Episode:
    episode = episode_of("p" * len(rows))
    steps = tuple(
        replace(step, decision=replace(step.decision, broken=row))
        for step, row in zip(episode.steps, rows, strict=True)
    )
    outcome = Outcome.ERROR if cut_short_by else Outcome.SUCCESS
    return replace(episode, steps=steps, outcome=outcome, cut_short_by=cut_short_by)


def test_runs_of_the_same_are_one():
    rows = ((), (POLICY,), (POLICY,), (GATE, POLICY), (GATE, POLICY), (POLICY,))
    kept = broken_steps(with_broken(*rows, cut_short_by=POLICY))
    assert kept == (
        BrokenSteps(1, 3, (POLICY,)),
        BrokenSteps(3, 5, (GATE, POLICY)),
        BrokenSteps(5, 6, (POLICY,)),
        BrokenSteps(6, 7, (POLICY,)),
    )
    by_step = broken_by_step(kept, len(rows))
    assert [by_step.get(place, ()) for place in range(7)] == [*rows, (POLICY,)]
    assert broken_from_json([asdict(run) for run in kept]) == kept


def test_where_nothing_broke_there_is_nothing():
    assert broken_steps(with_broken((), ())) == ()
    assert broken_from_json([]) == ()


@pytest.mark.parametrize(
    "content",
    [
        None,
        7,
        ["x"],
        [{}],
        [{"start": 2, "stop": 2, "broken": []}],
        [{"start": -1, "stop": 2, "broken": []}],
        [{"start": 0, "stop": 1.5, "broken": []}],
        [{"start": 0, "stop": 1, "broken": None}],
        [{"start": 0, "stop": 1, "broken": ["policy"]}],
        [{"start": 0, "stop": 1, "broken": [{"who": 1, "what": "x"}]}],
    ],
)
def test_what_is_none_of_it_is_refused(content):
    with pytest.raises(ValueError, match=r"wanted|no field"):
        broken_from_json(content)


def test_what_a_header_claims_beyond_its_steps_costs_nothing():
    assert len(broken_by_step([BrokenSteps(0, 10**15, (POLICY,))], 3)) == 4
