"""What is learned on FetchPickAndPlace."""

from sheath_manip.experiments.study import Study
from sheath_manip.learning.config import LearningPlan
from sheath_manip.policies.config import PolicyConfig
from tools.outside.fetch import FETCH

FULL = LearningPlan(policy=PolicyConfig("mlp")).changed(
    gate={
        "embedding": "scaled-features",
        "precedent_embedding": "scaled-features",
    },
    schedule={"demonstrations": 10, "rounds": 4, "episodes": 10},
    comparison={"methods": ("dagger", "sheath", "random-takeover"), "evaluation_episodes": 20},
)
STUDY = Study(FETCH, plans={"full": FULL})
