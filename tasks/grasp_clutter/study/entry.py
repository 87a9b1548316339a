"""The study of grasping in clutter."""

from sheath_manip.experiments.study import Study
from sheath_manip.gates.config import GateConfig
from sheath_manip.learning.config import Comparison, LearningPlan, Schedule
from sheath_manip.policies.config import PolicyConfig
from sheath_manip.support.config import ThresholdConfig
from sheath_manip.tasks.grasp_clutter.entry import GRASP_CLUTTER
from sheath_manip.tasks.grasp_clutter.study.claims import CLAIMS, HARD, RECIPE
from sheath_manip.tasks.grasp_clutter.study.probes import PROBES

_FULL = LearningPlan(
    policy=PolicyConfig("spatial-cnn", {"steps": 1000, "warm_steps": 600}),
    gate=GateConfig(
        signal="near-joined",
        embedding="wrist-convolutions",
        precedent_embedding="wrist-convolutions",
        threshold=ThresholdConfig(false_alarm_rate=0.1),
        minimum_hold_steps=5,
        # 4 s, so that what is stuck is noticed within 5.
        stuck_steps=80,
    ),
    schedule=Schedule(
        demonstrations=60,
        calibration=20,
        false_alarm_episodes=10,
        rounds=6,
        episodes=16,
        variant="medium",
    ),
    comparison=Comparison(evaluation_episodes=10, final_episodes=100, final_variant="medium"),
)

STUDY = Study(
    task=GRASP_CLUTTER,
    plans={
        "full": _FULL,
        "quick": _FULL.changed(
            policy={"settings": {"steps": 60, "warm_steps": 20}},
            schedule={
                "demonstrations": 6,
                "calibration": 4,
                "false_alarm_episodes": 2,
                "rounds": 2,
                "episodes": 3,
            },
            comparison={
                "methods": ("dagger", "sheath"),
                "seeds": (0,),
                "evaluation_episodes": 2,
                "final_episodes": 2,
            },
        ),
        # The same with less room between the objects.
        "hard": _FULL.changed(
            schedule={"variant": "default"}, comparison={"final_variant": "final"}
        ),
        # The best policy: many scenes, and a hand that is pushed about, which shows the ways back.
        "recipe": _FULL.changed(
            policy={"settings": {"steps": 4000, "warm_steps": 1000}},
            schedule={
                "demonstrations": 200,
                "demonstration_noise": 0.15,
                "calibration": 10,
                "false_alarm_episodes": 1,
                "rounds": 1,
                "episodes": 20,
            },
            comparison={"methods": ("cloning",), "seeds": (0,), "evaluation_episodes": 1},
        ),
    },
    claims=CLAIMS,
    plan_claims={"hard": HARD, "recipe": RECIPE},
    probes=PROBES,
)
