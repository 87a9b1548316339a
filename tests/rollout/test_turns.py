"""Who acts is asked and told of its turn, and starts anew with each episode."""

import numpy as np
import pytest

from sheath_manip.exceptions import ParameterError
from sheath_manip.gates import Mixture
from sheath_manip.rollout.cached_expert import CachedExpert
from sheath_manip.types import Action, Actor, GateDecision, Observation, Proposal, Reason
from tests.rollout.corridor_episode import Saying, Scripted, run, still
from tests.toy import CHOICES, Corridor, MiddleKeeper


def test_gate_and_expert_start_anew_with_each_episode():
    gate = Mixture(0.5)
    expert = Scripted(lambda _: CHOICES[1])
    twice = [run(gate, still(), expert) for _ in range(2)]
    actors = [[step.decision.actor for step in episode.steps] for episode in twice]
    assert actors[0] == actors[1]
    assert set(actors[0]) == {Actor.POLICY, Actor.EXPERT}
    assert expert.resets == 2


def test_an_expert_is_told_of_each_of_its_turns_before_it_is_asked():
    class Device(Scripted):
        def __init__(self) -> None:
            super().__init__(lambda _: CHOICES[1])
            self.book: list[tuple[str, Observation]] = []

        def follow(self, observation: Observation) -> None:
            self.book.append(("follow", observation))

        def take_over(self, observation: Observation) -> None:
            self.book.append(("take over", observation))

        def act(self, observation: Observation) -> Action:
            self.book.append(("act", observation))
            return super().act(observation)

    # Asked for labels too, so that being asked does not tell it of its turn.
    for device in (first := Device(), second := Device()):
        expert = device if device is first else CachedExpert(device)
        episode = run(Mixture(0.5), still(), expert)
        wanted = []
        before = None
        for step in episode.steps:
            wanted.append(("follow", step.observation))
            if step.decision.actor is Actor.EXPERT is not before:
                wanted.append(("take over", step.observation))
            if step.labelled is not None:
                wanted.append(("act", step.observation))
            before = step.decision.actor
        assert len([name for name, _ in wanted if name == "take over"]) > 1
        assert device.book == wanted
    assert len(second.book) == len(first.book)


class Named:
    """A gate that names one actor after the other, and asks for labels as it is told."""

    def __init__(self, actors: list[Actor], query: bool = False) -> None:
        self.actors = actors
        self.query = query

    def reset(self, rng: np.random.Generator) -> None:
        del rng
        self.left = list(self.actors)

    def decide(self, observation: Observation, proposal: Proposal | None) -> GateDecision:
        del observation, proposal
        return GateDecision(self.left.pop(0), self.query, Reason.PERSON)


@pytest.mark.parametrize("query", [True, False])
def test_the_one_that_the_gate_names_is_asked_and_nobody_else(query):
    turns = [Actor.POLICY, Actor.OPERATOR, Actor.HOLD, Actor.EXPERT, Actor.FALLBACK, Actor.POLICY]
    gate = Named(2 * turns, query)
    operator, hold, fallback, expert = (Scripted(lambda _: CHOICES[1]) for _ in range(4))
    others = {Actor.OPERATOR: operator, Actor.HOLD: hold, Actor.FALLBACK: fallback}
    episode = run(gate, still(), expert, others=others)
    assert [step.decision.actor for step in episode.steps] == 2 * turns
    assert [one.asked for one in (operator, hold, fallback)] == [2, 2, 2]
    assert [one.resets for one in (operator, hold, fallback, expert)] == [1, 1, 1, 1]
    # Twice it acts itself, and four times it is asked for a label where the policy acts.
    assert expert.asked == (6 if query else 2)
    for step in episode.steps:
        by_policy = step.decision.actor is Actor.POLICY
        assert step.executed is (step.proposed if by_policy else step.labelled)
        assert step.proposed is not None
        assert (step.label is not None) == query


def test_an_actor_that_is_not_there_is_named():
    with pytest.raises(ParameterError, match="asks for the operator"):
        run(Named([Actor.OPERATOR]), still(), Scripted(lambda _: CHOICES[1]))


def test_one_in_two_places_starts_each_episode_once_and_is_told_of_both_turns():
    class Device(Scripted):
        turns = 0
        seen = 0

        def follow(self, observation: Observation) -> None:
            del observation
            self.seen += 1

        def take_over(self, observation: Observation) -> None:
            del observation
            self.turns += 1

    device = Device(lambda _: CHOICES[1])
    turns = [Actor.EXPERT, Actor.OPERATOR, Actor.OPERATOR, Actor.POLICY]
    episode = run(Named(3 * turns), still(), device, others={Actor.OPERATOR: device})
    assert (device.resets, device.seen, device.turns) == (1, len(episode), 6)


def test_a_policy_draws_apart_from_the_gate_and_the_same_in_the_same_episode():
    class Drawing(Saying):
        def reset(self, rng: np.random.Generator) -> None:
            self.drew.append(float(rng.random()))

    policy = Drawing(lambda _: CHOICES[1])
    actors = [
        [step.decision.actor for step in run(Mixture(0.5), one, MiddleKeeper(Corridor())).steps]
        for one in (still(), policy, policy)
    ]
    assert actors[0] == actors[1] == actors[2]
    assert policy.drew[0] == policy.drew[1] != np.random.default_rng(0).random()
