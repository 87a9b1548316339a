"""What every gate must do."""

from collections.abc import Callable, Sequence

import numpy as np
import pytest

from sheath_manip.cockpit import Cockpit, PersonGate
from sheath_manip.exceptions import ParameterError
from sheath_manip.gates import (
    AlwaysExpert,
    AlwaysPolicy,
    AttentivePerson,
    HumanGate,
    Mixture,
    QueryFilter,
    RandomTakeover,
    SupportGate,
)
from sheath_manip.gates.blocks import BlocksConfig, RandomBlocks
from sheath_manip.gates.labels.drawn_steps import DrawnSteps
from sheath_manip.gates.labels.gate import LabellingGate
from sheath_manip.protocols import Gate
from sheath_manip.rollout.simulated_operator import OperatorConfig, SimulatedOperator
from sheath_manip.types import (
    Action,
    ActionSpec,
    Actor,
    GateDecision,
    Judgement,
    Observation,
    Proposal,
    Reason,
    TaskSpec,
)
from tests.judging import ByObservation, always

PROPOSED = Proposal(np.zeros((1, 1), dtype=np.float32))


def seen(score: float) -> Observation:
    """An observation whose one feature is the score that it will get."""
    return Observation({}, np.array([score], dtype=np.float32), 0.0)


def first_feature_of(observation: Observation) -> float:
    return float(observation.features[0])


FIRST_FEATURE = ByObservation(first_feature_of)


class Doubter:
    """An expert who proposes the first feature, so would do otherwise than 0."""

    def reset(self) -> None:
        pass

    def act(self, observation: Observation) -> Action:
        return observation.features[:1]


RATE_HZ = 10.0
SPEC = TaskSpec(
    name="doubts",
    control_rate_hz=RATE_HZ,
    action=ActionSpec(
        ("side_m",), np.full(1, -2.0, np.float32), np.full(1, 2.0, np.float32), tolerance=0.25
    ),
    cameras={},
    feature_names=("side_m",),
    max_steps=100,
    metric="side_m",
)


def watching(config: OperatorConfig) -> AttentivePerson:
    """A person who passes differences of up to 1 m, and judges by each step alone."""
    return AttentivePerson(Doubter(), SPEC, SimulatedOperator(config), while_s=0.0)


GATES: dict[str, Callable[[], Gate]] = {
    "always-expert": AlwaysExpert,
    "always-policy": AlwaysPolicy,
    "always-policy, all labelled": lambda: AlwaysPolicy(query=True),
    "mixture": lambda: Mixture(0.5),
    "takeover": lambda: RandomTakeover(0.3),
    "takeover, own labels": lambda: RandomTakeover(0.3, query=False),
    "blocks": lambda: RandomBlocks(BlocksConfig(0.1, (3, 8))),
    "takeover, some labels": lambda: LabellingGate(
        RandomTakeover(0.3, query=False), [DrawnSteps(0.2)], an_episode=9
    ),
    "query filter": lambda: QueryFilter(FIRST_FEATURE, 0.0),
    "human": lambda: HumanGate(watching(OperatorConfig(0.3))),
    "human, who overlooks much": lambda: HumanGate(watching(OperatorConfig(overlooked=0.7))),
    "person, who never comes": lambda: PersonGate(
        SupportGate(FIRST_FEATURE, 0.0), Cockpit(), 20.0, wait_s=0.0
    ),
    "person, who is waited for": lambda: PersonGate(
        SupportGate(FIRST_FEATURE, 0.0), Cockpit(), 20.0, wait_s=float("inf"), stands_still=False
    ),
    "support": lambda: SupportGate(FIRST_FEATURE, 0.0),
    "support, held": lambda: SupportGate(FIRST_FEATURE, 0.0, False, 0.5, 2, 4),
}
SCORES = np.random.default_rng(0).normal(size=200).tolist()


def run(gate: Gate, seed: int = 0, scores: Sequence[float] = SCORES) -> list[GateDecision]:
    gate.reset(np.random.default_rng(seed))
    return [gate.decide(seen(score), PROPOSED) for score in scores]


def key(decision: GateDecision) -> tuple:
    return decision.actor, decision.query, decision.reason, repr(decision.score)


@pytest.mark.parametrize("name", GATES)
def test_decisions_are_of_the_declared_types(name):
    for decision in run(GATES[name]()):
        assert isinstance(decision.actor, Actor)
        assert isinstance(decision.query, bool)
        assert isinstance(decision.reason, Reason)
        assert isinstance(decision.score, float)
        assert isinstance(decision.threshold, float)


@pytest.mark.parametrize("name", GATES)
def test_where_another_than_the_policy_drives_there_is_a_label_and_where_nobody_does_none(name):
    decisions = [d for d in run(GATES[name]()) if d.actor is not Actor.POLICY]
    assert all(d.query is d.actor.in_place_of_policy for d in decisions)


@pytest.mark.parametrize("name", GATES)
def test_reset_forgets_and_the_rng_decides(name):
    gate = GATES[name]()
    first = [key(decision) for decision in run(gate)]
    gate.decide(seen(-9.0), None)
    assert [key(decision) for decision in run(gate)] == first
    assert [key(decision) for decision in run(GATES[name]())] == first


@pytest.mark.parametrize("name", GATES)
def test_without_a_valid_proposal_the_policy_does_not_act(name):
    gate = GATES[name]()
    gate.reset(np.random.default_rng(0))
    for score in (1.0, -1.0, float("nan")):
        decision = gate.decide(seen(score), None)
        assert decision.actor is not Actor.POLICY
        assert decision.query is decision.actor.in_place_of_policy


@pytest.mark.parametrize("gate", [Mixture(0.3), RandomTakeover(0.3)])
def test_drawn_gates_keep_their_share_and_label_everything(gate):
    decisions = run(gate, scores=[0.0] * 4000)
    assert np.mean([d.actor is Actor.EXPERT for d in decisions]) == pytest.approx(0.3, abs=0.03)
    assert all(d.query and d.reason is Reason.DRAWN for d in decisions)
    assert [d.actor for d in run(gate, seed=1)] != [d.actor for d in run(gate, seed=2)]


@pytest.mark.parametrize("make", [Mixture, RandomTakeover])
@pytest.mark.parametrize("share", [-0.1, 1.1, float("nan")])
def test_a_share_outside_0_to_1_is_refused(make, share):
    with pytest.raises(ParameterError, match="wanted"):
        make(share)


@pytest.mark.parametrize("make", [Mixture, RandomTakeover])
def test_the_ends_of_the_range_are_exact(make):
    assert {d.actor for d in run(make(0.0))} == {Actor.POLICY}
    assert {d.actor for d in run(make(1.0))} == {Actor.EXPERT}


def actors(gate: Gate, scores: list[float]) -> str:
    return "".join(d.actor.value[0] for d in run(gate, scores=scores))


def test_the_papers_gate_follows_the_score():
    gate = SupportGate(FIRST_FEATURE, 0.5)
    decisions = run(gate, scores=[0.6, 0.4, 0.5, -1.0])
    assert [d.actor.value[0] for d in decisions] == ["p", "e", "p", "e"]
    assert [d.reason for d in decisions] == [
        Reason.INSIDE,
        Reason.OUTSIDE,
        Reason.INSIDE,
        Reason.OUTSIDE,
    ]
    assert all(d.query and d.threshold == 0.5 for d in decisions)
    assert [round(d.score, 3) for d in decisions] == [0.6, 0.4, 0.5, -1.0]


def test_only_the_experts_own_steps_are_labelled_on_request():
    decisions = run(SupportGate(FIRST_FEATURE, 0.0, query=False), scores=[1.0, -1.0, 1.0])
    assert [d.query for d in decisions] == [False, True, False]


def test_random_takeover_labels_its_own_steps_alone_on_request():
    decisions = run(RandomTakeover(0.3, query=False))
    assert all(d.query is (d.actor is Actor.EXPERT) for d in decisions)
    assert [d.actor for d in decisions] == [d.actor for d in run(RandomTakeover(0.3))]


@pytest.mark.parametrize("seed", range(5))
def test_the_query_filter_never_takes_over_and_asks_where_sheath_would(seed):
    scores = np.random.default_rng(seed).normal(size=300)
    scores[::50] = np.nan
    decisions = run(QueryFilter(FIRST_FEATURE, 0.2), scores=scores.tolist())
    assert {d.actor for d in decisions} == {Actor.POLICY}
    sheath = run(SupportGate(FIRST_FEATURE, 0.2), scores=scores.tolist())
    assert [d.query for d in decisions] == [d.actor is Actor.EXPERT for d in sheath]
    assert [d.reason for d in decisions] == [d.reason for d in sheath]


def test_no_score_means_the_expert():
    decision = SupportGate(always(float("nan"), Reason.RISK), 0.0).decide(seen(0.0), PROPOSED)
    assert (decision.actor, decision.reason) == (Actor.EXPERT, Reason.NO_SCORE)
    assert np.isnan(decision.score)


def test_an_arithmetic_error_in_the_score_means_the_expert_and_others_show():
    decision = SupportGate(ByObservation(lambda _: 1 / 0), 0.0).decide(seen(0.0), PROPOSED)
    assert (decision.actor, decision.reason) == (Actor.EXPERT, Reason.NO_SCORE)
    with pytest.raises(KeyError):
        SupportGate(ByObservation(lambda _: {}["score"]), 0.0).decide(seen(0.0), PROPOSED)


def test_an_invalid_proposal_is_named():
    decision = SupportGate(FIRST_FEATURE, 0.0).decide(seen(1.0), None)
    assert (decision.actor, decision.reason) == (Actor.EXPERT, Reason.INVALID_PROPOSAL)


@pytest.mark.parametrize("gate", [SupportGate, QueryFilter])
def test_what_is_judged_is_the_proposal_itself_and_once_a_step(gate):
    judged: list[tuple[Observation, Proposal]] = []

    class Judging:
        def judge(
            self, observation: Observation, proposal: Proposal, threshold: float
        ) -> Judgement:
            del threshold
            judged.append((observation, proposal))
            return Judgement(-1.0, Reason.RISK)

    here, gate = seen(0.0), gate(Judging(), 0.0)
    assert gate.decide(here, PROPOSED).reason is Reason.RISK
    assert gate.decide(here, None).reason is Reason.INVALID_PROPOSAL
    assert len(judged) == 1
    assert judged[0][0] is here
    assert judged[0][1] is PROPOSED


def test_the_release_margin_holds_the_expert():
    gate = SupportGate(FIRST_FEATURE, 0.0, release_margin=0.5)
    scores = [0.1, -0.1, 0.1, 0.4, 0.5, 0.1]
    assert actors(gate, scores) == "peeepp"
    assert run(gate, scores=scores)[3].reason is Reason.HOLD


def test_quiet_steps_must_be_in_a_row():
    gate = SupportGate(FIRST_FEATURE, 0.0, quiet_steps=2)
    assert actors(gate, [-1, 1, -1, 1, 1, 1, 1]) == "eeeeepp"
    assert actors(gate, [-1, 1, float("nan"), 1, 1, 1]) == "eeeeep"


def test_a_takeover_lasts_its_minimum():
    gate = SupportGate(FIRST_FEATURE, 0.0, minimum_hold_steps=3)
    assert actors(gate, [1, -1, 1, 1, 1, 1, -1, 1]) == "peeeppee"


def test_parameters_outside_their_range():
    with pytest.raises(ParameterError, match="threshold"):
        SupportGate(FIRST_FEATURE, float("nan"))
    for wrong in ((-0.1, 0, 0), (0.0, -1, 0), (0.0, 0, -1)):
        with pytest.raises(ParameterError, match="at least 0"):
            SupportGate(FIRST_FEATURE, 0.0, True, *wrong)
