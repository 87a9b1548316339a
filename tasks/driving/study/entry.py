"""Driving's study."""

from typing import Any

from sheath_manip.experiments.study import Study
from sheath_manip.gates.config import GateConfig
from sheath_manip.learning.config import Comparison, LearningPlan, Schedule
from sheath_manip.policies.config import PolicyConfig
from sheath_manip.support.config import ThresholdConfig
from sheath_manip.tasks.driving.entry import DRIVING
from sheath_manip.tasks.driving.study.claims import CLAIMS
from sheath_manip.tasks.driving.study.probes import PROBES


def _support(*arguments: Any) -> None:
    """Draw `figures.support`; matplotlib is imported only now."""
    from sheath_manip.tasks.driving.study.figures import support

    support(*arguments)


def _gate_map(*arguments: Any) -> None:
    """Draw `figures.gate_map`; matplotlib is imported only now."""
    from sheath_manip.tasks.driving.study.figures import gate_map

    gate_map(*arguments)


# What a person could be asked: turns of a second, and under one an episode once the policy is good.
# On tuning seeds: at 5 % false alarms about two an episode in each round; at 1.5 % .1 to 1.1, but
# the first policy, which fails most, was let go too far. From 6 % in the first round down to 1.5 %
# one of 256 episodes failed, and in the last there were .7 an episode, for 5 % of the steps.
_GATE = GateConfig(
    threshold=ThresholdConfig(false_alarm_rate=0.015),
    minimum_hold_steps=10,
    # 4 s: a car cannot stand, but drive round and round, and is noticed within 5.
    stuck_steps=40,
)
_FIRST_RATE = 0.06
# For how the support's size changes learning (the draft's section IV-B): the support alone, at its
# own boundary.
_NU = LearningPlan(
    gate=GateConfig(signal="support", threshold=ThresholdConfig(rule="boundary")),
    schedule=Schedule(
        demonstrations=6, calibration=3, false_alarm_episodes=3, rounds=4, episodes=4
    ),
    comparison=Comparison(methods=("sheath",), seeds=(0,), evaluation_episodes=8, final_episodes=1),
)

STUDY = Study(
    task=DRIVING,
    plans={
        "full": LearningPlan(gate=_GATE, schedule=Schedule(first_false_alarm_rate=_FIRST_RATE)),
        # As in the draft: three laps, one convolution layer, the support on its last hidden layer.
        "paper": LearningPlan(
            policy=PolicyConfig("paper-cnn"),
            gate=GateConfig(embedding="penultimate"),
            schedule=Schedule(demonstrations=3),
        ),
        "nu": _NU,
        # Without a network to train.
        "nu-quick": _NU.changed(
            policy={"name": "hog-svm"},
            gate={"embedding": "pixels", "precedent_embedding": "pixels"},
            schedule={
                "demonstrations": 2,
                "false_alarm_episodes": 1,
                "rounds": 2,
                "episodes": 2,
            },
            comparison={"evaluation_episodes": 2},
        ),
        # Painting doubles a cold fit, and a first look can do without.
        "quick": LearningPlan(
            policy=PolicyConfig("plain-cnn"),
            gate=_GATE,
            schedule=Schedule(
                demonstrations=6,
                calibration=4,
                false_alarm_episodes=3,
                rounds=2,
                episodes=4,
                first_false_alarm_rate=_FIRST_RATE,
            ),
            comparison=Comparison(
                methods=("dagger", "sheath"),
                seeds=(0,),
                evaluation_episodes=3,
                final_episodes=2,
            ),
        ),
    },
    figures={"support.png": _support, "gate_map.png": _gate_map},
    claims=CLAIMS,
    probes=PROBES,
)
