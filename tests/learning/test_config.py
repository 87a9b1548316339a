"""Settings by role, and the flat plans of before."""

import json

import pytest

from sheath_manip.exceptions import ParameterError, UnknownNameError
from sheath_manip.files.json_files import plain
from sheath_manip.gates.config import GateConfig
from sheath_manip.learning.config import Comparison, LearningPlan, Schedule
from sheath_manip.learning.flat_plans import PLACES, upgraded
from sheath_manip.policies.config import PolicyConfig
from sheath_manip.support.config import SupportConfig, ThresholdConfig

FLAT = {
    "policy": "hog-svm",
    "signal": "support",
    "nu": 0.2,
    "check": 7,
    "held_out": 9,
    "demonstrations": 3,
    "seeds": [4],
}


def test_a_gates_config_is_plain_and_comes_back():
    config = GateConfig(
        signal="support",
        support=SupportConfig("neighbors", nu=0.2),
        threshold=ThresholdConfig(rule="budget"),
        quiet_steps=3,
        labels="own",
    )
    described = json.loads(json.dumps(config.described()))
    assert GateConfig.from_described(described) == config
    assert GateConfig.from_described({}) == GateConfig()


@pytest.mark.parametrize("content", [{"colour": 1}, {"support": {"colour": 1}}])
def test_an_unknown_setting_is_named(content):
    with pytest.raises(ParameterError, match="colour"):
        GateConfig.from_described(content)


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: SupportConfig(nu=0.0), "nu is 0.0; wanted"),
        (lambda: SupportConfig(bandwidth_factor=-1.0), "bandwidth_factor is -1.0; wanted"),
        (lambda: ThresholdConfig(false_alarm_rate=1.0), "false_alarm_rate is 1.0; wanted"),
        (lambda: ThresholdConfig(expert_budget=0.0), "expert_budget is 0.0; wanted"),
        (lambda: GateConfig(release_rate=1.0), "release_rate is 1.0; wanted"),
        (lambda: GateConfig(minimum_hold_steps=-1), "minimum_hold_steps is -1; wanted"),
        (lambda: GateConfig(labels="some"), "wanted all, own, drawn"),
        (lambda: Schedule(rounds=0), "rounds is 0; wanted"),
        (lambda: Schedule(calibration=2), "calibration is 2; the threshold wants"),
        (lambda: Schedule(alpha=0.0), "alpha is 0.0; wanted"),
        (lambda: Schedule(demonstration_noise=-0.1), "demonstration_noise is -0.1; wanted"),
        (lambda: Schedule(beta=1.0), "beta is 1.0; wanted"),
        (lambda: Comparison(methods=()), "methods is empty; wanted"),
        (lambda: Comparison(final_episodes=0), "final_episodes is 0; wanted"),
        (lambda: PolicyConfig(settings=3), "settings is 3; wanted"),  # pyright: ignore
    ],
)
def test_a_value_outside_its_range_is_refused(make, said):
    with pytest.raises(ParameterError, match=said):
        make()


def test_an_unknown_rule_is_told():
    with pytest.raises(UnknownNameError, match="did you mean budget"):
        ThresholdConfig(rule="buget")


def test_a_plan_changes_in_one_part():
    plan = LearningPlan(policy=PolicyConfig(settings={"steps": 4, "channels": (8,)}))
    changed = plan.changed(
        gate={"support": {"nu": 0.1}, "quiet_steps": 2},
        policy={"settings": {"steps": 2}},
        comparison={"seeds": (3,)},
    )
    assert changed.gate == GateConfig(support=SupportConfig(nu=0.1), quiet_steps=2)
    assert changed.policy == PolicyConfig(settings={"steps": 2})
    assert changed.comparison.seeds == (3,)
    assert changed.schedule == plan.schedule
    with pytest.raises(UnknownNameError, match="setting of GateConfig 'colour'"):
        plan.changed(gate={"colour": 1})


def test_flat_plans_are_read_wherever_they_stand():
    now = LearningPlan().changed(
        policy={"name": "hog-svm"},
        gate={"signal": "support", "support": {"nu": 0.2}},
        schedule={"false_alarm_episodes": 7, "demonstrations": 3},
        comparison={"evaluation_episodes": 9, "seeds": (4,)},
    )
    described = plain(now.described())
    assert upgraded(FLAT) == described
    held = {"plan": FLAT, "tasks": {"toy": {"learning": FLAT, "rows": [1]}}}
    assert upgraded(held) == {
        "plan": described,
        "tasks": {"toy": {"learning": described, "rows": [1]}},
    }
    assert upgraded(described) == described
    with pytest.raises(ParameterError, match="colour"):
        upgraded(FLAT | {"colour": 1})


def test_every_flat_setting_has_its_place():
    described = LearningPlan().described()
    for path in PLACES.values():
        at = described
        for part in path:
            at = at[part]


def test_in_the_first_rounds_the_gate_may_ask_more():
    plan = LearningPlan().changed(
        gate={"threshold": {"false_alarm_rate": 0.02}}, schedule={"first_false_alarm_rate": 0.06}
    )
    rates = [plan.for_round(number).gate.threshold.false_alarm_rate for number in (1, 2, 3, 9)]
    assert rates == [0.06, 0.03, 0.02, 0.02]
    assert plan.for_round(3) == plan
    assert LearningPlan().for_round(1) == LearningPlan()
    with pytest.raises(ParameterError, match="first_false_alarm_rate is 1"):
        Schedule(first_false_alarm_rate=1.0)
