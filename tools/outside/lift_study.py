"""What is learned on robosuite's Lift: as on Fetch, in fewer episodes, since each takes longer."""

from sheath_manip.experiments.study import Study
from tools.outside.fetch_study import FULL
from tools.outside.lift import LIFT

PLAN = FULL.changed(
    schedule={"episodes": 10},
    comparison={
        "evaluation_episodes": 3,
        "final_episodes": 10,
    },
)
STUDY = Study(LIFT, plans={"full": PLAN})
