"""What is learned on FetchPickAndPlace."""

from sheath_manip.experiments.study import Study
from sheath_manip.learning.config import LearningPlan
from sheath_manip.policies.config import PolicyConfig
from tools.outside.fetch import FETCH

# The gate's two numbers were chosen on the training seeds 0 to 2 and 100 to 104.
SEEDS = (10, 11, 12)
FULL = LearningPlan(
    PolicyConfig("mlp", {"feature_noise": 0.15, "steps": 1500, "warm_steps": 1000})
).changed(
    gate={
        "signal": "near-joined",
        "embedding": "scaled-features",
        "precedent_embedding": "scaled-features",
        "threshold": {"false_alarm_rate": 0.05},
        "minimum_hold_steps": 12,
    },
    schedule={
        "demonstrations": 10,
        "calibration": 30,
        "false_alarm_episodes": 5,
        "rounds": 4,
        "episodes": 20,
    },
    comparison={
        "seeds": SEEDS,
        "methods": ("dagger", "sheath", "random-takeover"),
        "evaluation_episodes": 10,
        "final_episodes": 20,
    },
)
STUDY = Study(FETCH, plans={"full": FULL})
