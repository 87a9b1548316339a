"""Which of the policy's steps get a label: by rules of a table, and no more than so many."""

import numpy as np
import pytest

from sheath_manip.exceptions import ParameterError
from sheath_manip.gates.config import GateConfig
from sheath_manip.gates.constant import AlwaysPolicy
from sheath_manip.gates.fitted import FittedGate
from sheath_manip.gates.labels.drawn_steps import DrawnSteps
from sheath_manip.gates.labels.every_step import EveryStep
from sheath_manip.gates.labels.gate import LabellingGate
from sheath_manip.gates.making import make_gate
from sheath_manip.gates.scheduled import ScheduledTakeovers
from sheath_manip.gates.takeover import RandomTakeover
from sheath_manip.types import Actor, GateDecision, Observation, Proposal

SEEN = Observation({}, np.zeros(1, np.float32), 0.0)
PROPOSED = Proposal(np.zeros((1, 1), np.float32))


def run(gate, steps: int = 400, seed: int = 0) -> list[GateDecision]:
    gate.reset(np.random.default_rng(seed))
    return [gate.decide(SEEN, PROPOSED) for _ in range(steps)]


def made(**settings) -> list[GateDecision]:
    """The decisions of the gate of random takeovers that a config with `settings` makes."""
    config = GateConfig(kind="random-takeover", expert_share=0.3).from_described(
        GateConfig(kind="random-takeover", expert_share=0.3).described() | settings
    )
    return run(make_gate(FittedGate(config, policy=None)))  # pyright: ignore[reportArgumentType]


def test_the_experts_own_steps_are_labelled_under_every_rule_and_who_acts_is_the_same():
    alone = [each.actor for each in run(RandomTakeover(0.3))]
    for names in ("all", "own", "drawn", "before-failure", "own+drawn"):
        decisions = made(labels=names)
        assert [each.actor for each in decisions] == alone
        assert all(each.query for each in decisions if each.actor is Actor.EXPERT)


def test_rules_label_all_none_or_a_share_of_the_policys_steps():
    def share(**settings) -> float:
        return float(np.mean([d.query for d in made(**settings) if d.actor is Actor.POLICY]))

    assert (share(labels="all"), share(labels="own")) == (1, 0)
    drawn = share(labels="drawn", labelling={"drawn_share": 0.2})
    assert drawn == pytest.approx(0.2, abs=0.07)
    assert share(labels="drawn+all") == 1


def test_an_episode_that_is_stuck_has_no_more_labels_than_others():
    gate = LabellingGate(ScheduledTakeovers([(50, 30)]), [EveryStep()], an_episode=20)
    for _ in range(2):
        decisions = run(gate)
        assert sum(d.query for d in decisions if d.actor is Actor.POLICY) == 20
        assert sum(d.query for d in decisions if d.actor is Actor.EXPERT) == 30


def test_each_rule_draws_for_itself():
    def asked(*rules) -> list[bool]:
        return [each.query for each in run(LabellingGate(AlwaysPolicy(), rules))]

    first = asked(DrawnSteps(0.3))
    assert first == asked(DrawnSteps(0.3))
    both = asked(DrawnSteps(0.3), DrawnSteps(0.3))
    assert sum(both) > sum(first)
    assert all(two for one, two in zip(first, both, strict=True) if one)


@pytest.mark.parametrize("names", ["some", "own+some", "", "own+"])
def test_a_rule_that_there_is_none_of_is_refused(names):
    with pytest.raises(ParameterError, match="wanted all, own, drawn, before-failure"):
        GateConfig(labels=names)


def test_only_a_rule_that_looks_back_has_a_time_before_a_failure():
    assert GateConfig(labels="own+drawn").hindsight_s == 0
    assert GateConfig(labels="own+before-failure").hindsight_s == 0.5


@pytest.mark.parametrize(
    "labelling", [{"an_episode": -1}, {"drawn_share": 1.5}, {"before_failure_s": -0.1}]
)
def test_numbers_out_of_their_range_are_refused(labelling):
    with pytest.raises(ParameterError, match=f"{next(iter(labelling))} is"):
        made(labelling=labelling)
