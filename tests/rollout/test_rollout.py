"""What the one loop writes down of an episode on the toy task, and that it replays to the bit."""

from dataclasses import replace

import numpy as np
import pytest

from sheath_manip.gates import AlwaysExpert, AlwaysPolicy, Mixture, SupportGate
from sheath_manip.types import (
    Action,
    Actor,
    Commanded,
    Limited,
    Observation,
    Outcome,
    Transition,
)
from tests.judging import ByObservation
from tests.rollout.corridor_episode import SEED, Saying, Scripted, run, still
from tests.toy import CHOICES, Corridor, MiddleKeeper


class Diary:
    """Writes down what it hears, in a book that it may share."""

    def __init__(self, name: str, book: list[tuple[str, str]]) -> None:
        self.name = name
        self.book = book
        self.steps = []

    def on_fit(self, states) -> None:
        del states
        raise AssertionError("a rollout fits nothing")

    def on_start(self, environment, info) -> None:
        assert environment.outcome() is Outcome.TIME_LIMIT
        assert info.seed == SEED
        self.book.append((self.name, "start"))

    def on_step(self, environment, step) -> None:
        del environment
        self.steps.append(step)
        self.book.append((self.name, "step"))

    def on_end(self, episode) -> None:
        assert tuple(self.steps) == episode.steps
        self.book.append((self.name, "end"))


def side_of(observation: Observation) -> float:
    """A support score: inside near the middle of the corridor."""
    return 0.2 - abs(float(observation.features[0]))


def test_t_steps_and_one_observation_more():
    environment = Corridor()
    episode = run(AlwaysExpert(), expert=MiddleKeeper(environment), environment=environment)
    assert len(episode) == 12
    assert [step.observation.time_s for step in episode.steps] == [i / 50 for i in range(12)]
    assert episode.final_observation.time_s == 12 / 50
    assert episode.final_state.tolist() == environment.state().tolist()
    assert (episode.terminated, episode.truncated) == (True, False)
    assert episode.outcome is Outcome.SUCCESS
    assert episode.metrics == {"progress": 1.0}


def test_the_experts_step_is_its_label():
    environment = Corridor()
    expert = Scripted(lambda index: CHOICES[index % 3])
    episode = run(AlwaysExpert(), expert=expert, environment=environment)
    assert expert.resets == 1
    assert expert.asked == len(episode)
    for index, step in enumerate(episode.steps):
        assert step.proposed is None
        assert step.executed is step.labelled
        np.testing.assert_array_equal(step.executed, CHOICES[index % 3])


def test_the_policys_step_is_its_proposal_and_nobody_is_asked():
    expert = Scripted(lambda _: CHOICES[0])
    episode = run(AlwaysPolicy(), still(), expert)
    assert expert.asked == 0
    assert all(s.labelled is None and s.executed is s.proposed for s in episode.steps)
    assert {step.decision.actor for step in episode.steps} == {Actor.POLICY}


def test_a_label_may_be_asked_for_where_the_policy_acts():
    expert = Scripted(lambda _: CHOICES[0])
    episode = run(AlwaysPolicy(query=True), still(), expert)
    assert expert.asked == len(episode)
    for step in episode.steps:
        np.testing.assert_array_equal(step.executed, CHOICES[1])
        np.testing.assert_array_equal(step.labelled, CHOICES[0])


@pytest.mark.parametrize("query", [True, False])
def test_under_a_support_gate_each_acts_in_its_own_states(query):
    environment = Corridor(steps=40)
    keeper = MiddleKeeper(environment)
    expert = Scripted(lambda _: keeper.act(None))  # pyright: ignore[reportArgumentType]
    episode = run(
        SupportGate(ByObservation(side_of), 0.0, query=query),
        still(),
        expert,
        environment=environment,
        seed=1,
    )
    assert episode.outcome is Outcome.SUCCESS
    acted = [step.decision.actor for step in episode.steps]
    assert set(acted) == {Actor.POLICY, Actor.EXPERT}
    for step in episode.steps:
        inside = side_of(step.observation) >= 0
        assert step.decision.actor is (Actor.POLICY if inside else Actor.EXPERT)
        assert step.executed is (step.proposed if inside else step.labelled)
        assert (step.labelled is not None) == (query or not inside)
    assert expert.asked == sum(step.labelled is not None for step in episode.steps)


def test_listeners_are_called_in_order():
    book: list[tuple[str, str]] = []
    first, second = Diary("first", book), Diary("second", book)
    episode = run(AlwaysPolicy(), still(), listeners=(first, second))
    events = ["start", *["step"] * len(episode), "end"]
    assert book == [(name, event) for event in events for name in ("first", "second")]


@pytest.mark.parametrize("start", [0, 5, 11])
def test_stored_states_replay_the_rest_to_the_bit(start):
    environment = Corridor()
    episode = run(Mixture(0.5), still(), MiddleKeeper(environment), environment=environment)
    other = Corridor()
    other.reset(episode.info.seed)
    seen = other.restore(episode.steps[start].state)
    for step in episode.steps[start:]:
        np.testing.assert_array_equal(other.state(), step.state)
        np.testing.assert_array_equal(seen.images["above"], step.observation.images["above"])
        np.testing.assert_array_equal(seen.features, step.observation.features)
        transition = other.step(step.executed)
        assert transition.reward == step.reward
        seen = transition.observation
    np.testing.assert_array_equal(other.state(), episode.final_state)
    final = episode.final_observation
    np.testing.assert_array_equal(seen.images["above"], final.images["above"])
    assert other.outcome() is episode.outcome


class Halved(Corridor):
    """A corridor with a command filter: it halves every step aside."""

    def step(self, action: Action) -> Transition:
        half = (action / 2).astype(np.float32)
        limited = (Limited("speed", float(abs(half[0]))),) if half[0] else ()
        return replace(super().step(half), commanded=Commanded(half, limited))


def test_what_a_command_filter_changed_is_in_the_step():
    episode = run(
        AlwaysPolicy(), Saying(lambda index: CHOICES[1 + index % 2]), environment=Halved()
    )
    for index, step in enumerate(episode.steps):
        np.testing.assert_array_equal(step.requested, CHOICES[1 + index % 2])
        assert step.requested is step.proposed
        np.testing.assert_array_equal(step.executed, CHOICES[1 + index % 2] / 2)
        assert [each.limit for each in step.limited] == ["speed"] * (index % 2)
