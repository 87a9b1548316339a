"""Gauze cutting's study."""

from sheath_manip.experiments.study import Study
from sheath_manip.gates.config import GateConfig
from sheath_manip.learning.config import Comparison, LearningPlan, Schedule
from sheath_manip.policies.config import PolicyConfig
from sheath_manip.support.config import ThresholdConfig
from sheath_manip.tasks.gauze_cutting.entry import GAUZE_CUTTING
from sheath_manip.tasks.gauze_cutting.study.claims import CLAIMS
from sheath_manip.tasks.gauze_cutting.study.open_loops import blind, registered
from sheath_manip.tasks.gauze_cutting.study.probes import PROBES

_FULL = LearningPlan(
    policy=PolicyConfig("egocentric-cnn", {"spatial_settings": {"steps": 800, "warm_steps": 600}}),
    gate=GateConfig(
        signal="near-joined",
        embedding="tool-points",
        precedent_embedding="tool-points",
        threshold=ThresholdConfig(false_alarm_rate=0.1),
        minimum_hold_steps=5,
        # 4 s, so that what is stuck is noticed within 5.
        stuck_steps=80,
    ),
    schedule=Schedule(
        # Few and clean: a policy cloned from them ruins most sheets. Where the expert's hand is
        # pushed about (`demonstration_noise` of .1) five will do to free 11 of 12 tuning scenes'
        # discs, and there is little to learn.
        demonstrations=20,
        calibration=15,
        false_alarm_episodes=8,
        rounds=5,
        episodes=10,
    ),
    comparison=Comparison(evaluation_episodes=6, final_episodes=40),
)

STUDY = Study(
    task=GAUZE_CUTTING,
    plans={
        "full": _FULL,
        "quick": _FULL.changed(
            policy={"settings": {"spatial_settings": {"steps": 40, "warm_steps": 10}}},
            schedule={
                "demonstrations": 4,
                "calibration": 3,
                "false_alarm_episodes": 1,
                "rounds": 1,
                "episodes": 2,
            },
            comparison={
                "methods": ("dagger", "sheath"),
                "seeds": (0,),
                "evaluation_episodes": 1,
                "final_episodes": 1,
            },
        ),
    },
    baselines={"registered": registered, "blind": blind},
    claims=CLAIMS,
    probes=PROBES,
)
