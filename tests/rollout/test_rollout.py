"""The one loop, on the toy task."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import cast

import numpy as np
import pytest

from sheath_manip.exceptions import ActionError, ParameterError
from sheath_manip.gates import AlwaysExpert, AlwaysPolicy, Mixture, SupportGate
from sheath_manip.protocols import Expert, Gate, Listener, Policy
from sheath_manip.rollout.cached_expert import CachedExpert
from sheath_manip.rollout.loop import rollout
from sheath_manip.types import (
    Action,
    Actor,
    Commanded,
    Episode,
    EpisodeInfo,
    GateDecision,
    Judgement,
    Limited,
    Observation,
    Observations,
    Outcome,
    Proposal,
    Purpose,
    Reason,
    Transition,
)
from tests.judging import ByObservation, always
from tests.toy import CHOICES, Corridor, MiddleKeeper

SEED = 4


class Scripted:
    """Acts as it is told, and counts how often it is asked."""

    def __init__(self, answer: Callable[[int], object]) -> None:
        self.answer = answer
        self.asked = 0
        self.resets = 0

    def reset(self) -> None:
        self.resets += 1

    def act(self, observation: Observation) -> Action:
        del observation
        self.asked += 1
        return cast(Action, self.answer(self.asked - 1))


class Saying:
    """A policy that proposes what it is told."""

    def __init__(self, answer: Callable[[int], object]) -> None:
        self.answer = answer
        self.asked = 0
        self.drew: list[float] = []

    def reset(self, rng: np.random.Generator) -> None:
        """Draw nothing."""

    def propose(self, observations: Observations) -> Proposal:
        assert len(observations) == 1
        self.asked += 1
        # A list, since not all that is tried here makes an array.
        return Proposal(cast(np.ndarray, [self.answer(self.asked - 1)]))


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


def run(
    gate: Gate,
    policy: Policy | None = None,
    expert: Expert | None = None,
    listeners: tuple[Listener, ...] = (),
    environment: Corridor | None = None,
    others: Mapping[Actor, Expert] | None = None,
    seed: int = SEED,
) -> Episode:
    return rollout(
        environment or Corridor(),
        EpisodeInfo("corridor", seed, Purpose.LEARNING, 50.0),
        gate,
        rng=np.random.default_rng(0),
        policy=policy,
        expert=expert,
        others=others or {},
        listeners=listeners,
    )


def still() -> Saying:
    """Proposes to stay: what the keeper of the middle says only now and then."""
    return Saying(lambda _: CHOICES[1])


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


@pytest.mark.parametrize(
    "proposal",
    [[np.nan], [0.31], [-np.inf], [0.0, 0.0], 0.0, None, "left", [[0.0], [0.0, 0.1]]],
    ids=["nan", "out of bounds", "infinite", "too long", "no axis", "none", "text", "ragged"],
)
@pytest.mark.parametrize(
    "gate",
    [AlwaysPolicy(), Mixture(0.0), SupportGate(always(1.0), 0.0)],
    ids=lambda g: type(g).__name__,
)
def test_a_proposal_that_is_no_action_hands_the_step_to_the_expert(gate, proposal):
    policy = Saying(lambda index: proposal if index == 3 else CHOICES[1])
    expert = Scripted(lambda _: CHOICES[2])
    steps = run(gate, policy, expert).steps
    broken = steps[3]
    assert broken.proposed is None
    assert (broken.decision.actor, broken.decision.reason) == (
        Actor.EXPERT,
        Reason.INVALID_PROPOSAL,
    )
    np.testing.assert_array_equal(broken.executed, CHOICES[2])
    assert broken.labelled is broken.executed
    others = [step for index, step in enumerate(steps) if index != 3]
    assert {step.decision.actor for step in others} == {Actor.POLICY}


def test_the_loop_does_not_trust_a_gate_with_an_invalid_proposal():
    class Careless(AlwaysPolicy):
        def decide(self, observation, proposal):
            return super().decide(observation, proposal or Proposal(CHOICES[1][None]))

    expert = Scripted(lambda _: CHOICES[0])
    episode = run(Careless(), Saying(lambda _: [np.nan]), expert)
    assert {step.decision.reason for step in episode.steps} == {Reason.INVALID_PROPOSAL}
    assert {step.decision.actor for step in episode.steps} == {Actor.EXPERT}


@pytest.mark.parametrize(
    "gate", [AlwaysPolicy(), SupportGate(always(1.0), 0.0)], ids=lambda g: type(g).__name__
)
def test_a_gate_that_wants_a_policy_says_so(gate):
    with pytest.raises(ParameterError, match="wants a policy"):
        run(gate, None, Scripted(lambda _: CHOICES[1]))


def test_a_gate_that_wants_an_expert_says_so():
    for gate, policy in ((AlwaysExpert(), None), (AlwaysPolicy(query=True), still())):
        with pytest.raises(ParameterError, match="asks for the expert"):
            run(gate, policy)
    with pytest.raises(ParameterError, match="nobody can take over"):
        run(AlwaysPolicy(), Saying(lambda _: [np.nan]))


@pytest.mark.parametrize("answer", [[np.nan], [9.0], [0.0, 0.0]])
def test_an_experts_action_that_is_none_is_an_error(answer):
    with pytest.raises(ActionError, match="sidestep_m"):
        run(AlwaysExpert(), None, Scripted(lambda _: answer))


def test_listeners_are_called_in_order():
    book: list[tuple[str, str]] = []
    first, second = Diary("first", book), Diary("second", book)
    episode = run(AlwaysPolicy(), still(), listeners=(first, second))
    events = ["start", *["step"] * len(episode), "end"]
    assert book == [(name, event) for event in events for name in ("first", "second")]


def test_gate_and_expert_start_anew_with_each_episode():
    gate = Mixture(0.5)
    expert = Scripted(lambda _: CHOICES[1])
    twice = [run(gate, still(), expert) for _ in range(2)]
    actors = [[step.decision.actor for step in episode.steps] for episode in twice]
    assert actors[0] == actors[1]
    assert set(actors[0]) == {Actor.POLICY, Actor.EXPERT}
    assert expert.resets == 2


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


class InChunks:
    """Draws the next three actions at once, and plays them: asked anew it would say otherwise."""

    def reset(self, rng: np.random.Generator) -> None:
        self.rng = rng
        self.left = np.zeros((0, 1), np.float32)

    def propose(self, observations: Observations) -> Proposal:
        assert len(observations) == 1
        if not len(self.left):
            self.left = CHOICES[self.rng.integers(3, size=3)]
        chunk, self.left = self.left, self.left[1:]
        return Proposal(chunk[None])


class Remembering:
    """Judges by the side to which the proposal goes, and remembers what it was shown."""

    def __init__(self) -> None:
        self.judged: list[tuple[Observation, Action]] = []

    def judge(self, observation: Observation, proposal: Proposal, threshold: float) -> Judgement:
        del threshold
        self.judged.append((observation, proposal.now[0]))
        return Judgement(float(proposal.now[0, 0]))


@pytest.mark.parametrize("threshold", [-9.0, 0.0])
def test_what_the_gate_judges_of_a_chunk_is_what_is_executed(threshold):
    judge = Remembering()
    expert = Scripted(lambda _: CHOICES[1])
    environment = Corridor(steps=60)
    judged_anew = 0
    for seed in range(4):
        judge.judged.clear()
        gate = SupportGate(judge, threshold)
        steps = run(gate, InChunks(), expert, environment=environment, seed=seed).steps
        assert len(judge.judged) == len(steps) >= 3
        for (observation, judged), step in zip(judge.judged, steps, strict=True):
            assert observation is step.observation
            np.testing.assert_array_equal(judged, step.proposed)
            inside = float(judged[0]) >= threshold
            assert step.decision.actor is (Actor.POLICY if inside else Actor.EXPERT)
            if inside:
                np.testing.assert_array_equal(step.executed, judged)
            judged_anew += not inside
    assert (judged_anew > 0) == (threshold == 0.0)


def test_the_action_judged_is_the_validated_one_also_of_a_chunk_in_another_type():
    class Doubles(InChunks):
        def propose(self, observations: Observations) -> Proposal:
            proposal = super().propose(observations)
            return replace(proposal, actions=np.asarray(proposal.actions, np.float64))

    judge = Remembering()
    steps = run(SupportGate(judge, -9.0, query=False), Doubles()).steps
    for (_, judged), step in zip(judge.judged, steps, strict=True):
        assert judged.dtype == step.executed.dtype == np.float32
        np.testing.assert_array_equal(step.executed, judged)


def test_a_chunk_whose_present_action_is_none_hands_the_step_to_the_expert():
    class Broken(InChunks):
        def propose(self, observations: Observations) -> Proposal:
            actions = super().propose(observations).actions.copy()
            actions[0, 0] = np.nan
            return Proposal(actions)

    steps = run(SupportGate(Remembering(), -9.0), Broken(), Scripted(lambda _: CHOICES[1])).steps
    assert {step.decision.reason for step in steps} == {Reason.INVALID_PROPOSAL}
    assert {step.decision.actor for step in steps} == {Actor.EXPERT}
